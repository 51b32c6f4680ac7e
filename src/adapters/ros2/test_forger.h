// For tests: a participant that announces, beside its own port, that of another process, and claims
// to hold that process's node: as anybody on an unsecured domain can.
#pragma once

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <memory>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "ros2/discovery_info.h"
#include "ros2/fast_dds.h"

namespace culprit::ros2 {

// As an announcement carries them: kind and port of a locator.
inline std::array<std::uint8_t, 8> on_the_wire(std::uint16_t port) {
  return {1, 0, 0, 0, static_cast<std::uint8_t>(port), static_cast<std::uint8_t>(port >> 8), 0, 0};
}

// Announces `instead` wherever the middleware announces `decoy`.
class ForgingTransport final : public fast_dds::transport::ChainingTransport {
 public:
  ForgingTransport(const fast_dds::transport::ChainingTransportDescriptor& descriptor,
                   std::uint16_t decoy, std::uint16_t instead)
      : ChainingTransport(descriptor), decoy_(on_the_wire(decoy)), instead_(on_the_wire(instead)) {}

  fast_dds::transport::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  bool send(fast_dds::fastrtps::SenderResource* sender, const fast_dds::fastrtps::octet* bytes,
            std::uint32_t size, fast_dds::fastrtps::LocatorsIterator* begin,
            fast_dds::fastrtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    std::vector<fast_dds::fastrtps::octet> forged(bytes, bytes + size);
    for (auto at = forged.begin();;) {
      at = std::search(at, forged.end(), decoy_.begin(), decoy_.end());
      if (at == forged.end()) break;
      at = std::copy(instead_.begin(), instead_.end(), at);
    }
    return sender->send(forged.data(), size, begin, end, timeout);
  }
  void receive(fast_dds::transport::TransportReceiverInterface* next,
               const fast_dds::fastrtps::octet* bytes, std::uint32_t size,
               const fast_dds::fastrtps::Locator_t& local,
               const fast_dds::fastrtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  const std::array<std::uint8_t, 8> decoy_;
  const std::array<std::uint8_t, 8> instead_;
};

struct ForgingDescriptor final : fast_dds::transport::ChainingTransportDescriptor {
  ForgingDescriptor(std::shared_ptr<fast_dds::transport::TransportDescriptorInterface> below,
                    std::uint16_t decoy_port, std::uint16_t forged_port)
      : ChainingTransportDescriptor(std::move(below)), decoy(decoy_port), forged(forged_port) {}
  fast_dds::transport::TransportInterface* create_transport() const override {
    return new ForgingTransport(*this, decoy, forged);
  }
  const std::uint16_t decoy;
  const std::uint16_t forged;
};

struct Bound {
  int descriptor = -1;
  std::uint16_t port = 0;
};

inline Bound bound() {
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

inline std::uint16_t free_port() {
  const Bound socket = bound();
  close(socket.descriptor);
  return socket.port;
}

class Forger {
 public:
  // `address`: of the network on which it is discovered.
  Forger(const ParticipantOptions& options, std::uint16_t victims_port,
         const std::string& address = "127.0.0.1") {
    const std::uint16_t decoy = free_port();
    fast_dds::dds::DomainParticipantQos qos = fast_dds::participant_qos(options, {}, {});
    auto udp = std::make_shared<fast_dds::transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back(address);
    udp->maxInitialPeersRange = 32;
    qos.transport().user_transports = {
        std::make_shared<ForgingDescriptor>(std::move(udp), decoy, victims_port)};
    auto& announced = qos.wire_protocol().builtin.metatrafficUnicastLocatorList;
    announced.push_back(fast_dds::locator(address, free_port()));
    announced.push_back(fast_dds::locator("127.0.0.1", decoy));
    auto* factory = fast_dds::dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(options.domain, qos);
    const std::string type(kDiscoveryInfoType);
    fast_dds::dds::TypeSupport(new fast_dds::RawType(type)).register_type(participant_);
    auto* topic = participant_->create_topic(std::string(kDiscoveryInfoTopic), type,
                                             fast_dds::dds::TopicQos());
    writer_ =
        participant_->create_publisher(fast_dds::dds::PublisherQos())
            ->create_datawriter(topic, fast_dds::writer_qos(rtps::qos::kDiscoveryInfoWriter, ""));
  }
  ~Forger() {
    participant_->delete_contained_entities();
    fast_dds::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  void says_that_it_holds(const NodeEntities& node) { says_that_it_holds(std::vector{node}); }
  void says_that_it_holds(std::vector<NodeEntities> nodes) {
    fast_dds::write(
        *writer_,
        encode_discovery_info({fast_dds::to_guid(participant_->guid()), std::move(nodes)},
                              GidSize::kHumbleAndOlder),
        {});
  }
  rtps::GuidPrefix prefix() const { return fast_dds::to_guid(participant_->guid()).prefix(); }

 private:
  fast_dds::dds::DomainParticipant* participant_ = nullptr;
  fast_dds::dds::DataWriter* writer_ = nullptr;
};

}  // namespace culprit::ros2
