// A participant that announces, beside its own port, that of another process, and says that it
// holds that process's node: as anybody on an unsecured domain can.
#include <algorithm>
#include <arpa/inet.h>
#include <csignal>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/fast_dds.h"
#include "ros2/live_test.h"
#include "ros2/process_finder.h"

namespace culprit::ros2 {
namespace {

using testing::Contains;

namespace dds = fast_dds::dds;
namespace rtps = fast_dds::rtps;
namespace transport = fast_dds::transport;

// As an announcement carries them: kind and port of a locator.
std::array<std::uint8_t, 8> on_the_wire(std::uint16_t port) {
  return {1, 0, 0, 0, static_cast<std::uint8_t>(port), static_cast<std::uint8_t>(port >> 8), 0, 0};
}

// Announces `instead` wherever the middleware announces `decoy`.
class ForgingTransport final : public transport::ChainingTransport {
 public:
  ForgingTransport(const transport::ChainingTransportDescriptor& descriptor, std::uint16_t decoy,
                   std::uint16_t instead)
      : ChainingTransport(descriptor), decoy_(on_the_wire(decoy)), instead_(on_the_wire(instead)) {}

  transport::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  bool send(rtps::SenderResource* sender, const rtps::octet* bytes, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    std::vector<rtps::octet> forged(bytes, bytes + size);
    for (auto at = forged.begin();;) {
      at = std::search(at, forged.end(), decoy_.begin(), decoy_.end());
      if (at == forged.end()) break;
      at = std::copy(instead_.begin(), instead_.end(), at);
    }
    return sender->send(forged.data(), size, begin, end, timeout);
  }
  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes,
               std::uint32_t size, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  const std::array<std::uint8_t, 8> decoy_;
  const std::array<std::uint8_t, 8> instead_;
};

struct ForgingDescriptor final : transport::ChainingTransportDescriptor {
  ForgingDescriptor(std::shared_ptr<transport::TransportDescriptorInterface> below,
                    std::uint16_t decoy_port, std::uint16_t forged_port)
      : ChainingTransportDescriptor(std::move(below)), decoy(decoy_port), forged(forged_port) {}
  transport::TransportInterface* create_transport() const override {
    return new ForgingTransport(*this, decoy, forged);
  }
  const std::uint16_t decoy;
  const std::uint16_t forged;
};

struct Bound {
  int descriptor = -1;
  std::uint16_t port = 0;
};

Bound bound() {
  Bound socket{::socket(AF_INET, SOCK_DGRAM, 0), 0};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(socket.descriptor, reinterpret_cast<const sockaddr*>(&address), size);
  getsockname(socket.descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  socket.port = ntohs(address.sin_port);
  return socket;
}

std::uint16_t free_port() {
  const Bound socket = bound();
  close(socket.descriptor);
  return socket.port;
}

// Another process, with a port of its own.
class Victim {
 public:
  Victim() {
    const Bound socket = bound();
    port_ = socket.port;
    pid_ = fork();
    while (pid_ == 0) pause();
    close(socket.descriptor);
  }
  ~Victim() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  int pid() const { return pid_; }
  std::uint16_t port() const { return port_; }

 private:
  int pid_ = 0;
  std::uint16_t port_ = 0;
};

class Forger {
 public:
  Forger(const ParticipantOptions& options, std::uint16_t victims_port) {
    const std::uint16_t decoy = free_port();
    dds::DomainParticipantQos qos = fast_dds::participant_qos(
        options, {}, std::make_shared<std::atomic<bool>>(true), std::make_shared<DatagramSources>(),
        std::make_shared<DatagramFilter>());
    auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->maxInitialPeersRange = 32;
    qos.transport().user_transports = {
        std::make_shared<ForgingDescriptor>(std::move(udp), decoy, victims_port)};
    for (const std::uint16_t port : {free_port(), decoy}) {
      qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(
          fast_dds::locator("127.0.0.1", port));
    }
    auto* factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(options.domain, qos);
    const std::string type(kDiscoveryInfoType);
    dds::TypeSupport(new fast_dds::RawType(type)).register_type(participant_);
    auto* topic =
        participant_->create_topic(std::string(kDiscoveryInfoTopic), type, dds::TopicQos());
    writer_ = participant_->create_publisher(dds::PublisherQos())
                  ->create_datawriter(topic, fast_dds::writer_qos(qos::kDiscoveryInfoWriter, ""));
  }
  ~Forger() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  void says_that_it_holds(const NodeEntities& node) {
    fast_dds::write(*writer_,
                    encode_discovery_info({fast_dds::to_guid(participant_->guid()), {node}},
                                          GidSize::kHumbleAndOlder),
                    {});
  }
  GuidPrefix prefix() const { return fast_dds::to_guid(participant_->guid()).prefix(); }

 private:
  dds::DomainParticipant* participant_ = nullptr;
  dds::DataWriter* writer_ = nullptr;
};

TEST(ForgedParticipant, DoesNotChooseWhichProcessANodeIs) {
  const Victim victim;
  const TestDomain domain;
  Graph::Options graph;
  graph.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  LiveContext watcher(domain.options(), graph);
  Forger forger(domain.options(), victim.port());
  forger.says_that_it_holds({"/", "camera", {}, {}});
  ASSERT_TRUE(watcher.sees_node("/camera"));
  watcher.run([&] {
    const ParticipantInfo* info = watcher->graph().participant(forger.prefix());
    ASSERT_NE(info, nullptr);
    EXPECT_THAT(info->metatraffic, Contains(UdpAddress{{127, 0, 0, 1}, victim.port()}))
        << "it says that it listens there";
    ASSERT_EQ(watcher->graph().nodes().size(), 1u);
    EXPECT_EQ(watcher->graph().nodes()[0].node.pid, 0) << "the victim is " << victim.pid();
  });
  EXPECT_TRUE(watcher.changes().wait_for_one([](const GraphChange& change) {
    const auto* trouble = std::get_if<GraphTrouble>(&change);
    return trouble != nullptr &&
           trouble->text.find("the process of /camera is not proven") != std::string::npos;
  }));
}

}  // namespace
}  // namespace culprit::ros2
