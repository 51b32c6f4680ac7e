// Robots whose nodes find one another through a discovery server of Fast DDS.
#include <cstdlib>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ros2/fast_dds.h"
#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/publisher.h"
#include "ros2/test_forger.h"

namespace culprit::ros2 {
namespace {

// As `fastdds discovery -i 1 -l 127.0.0.1 -p PORT` runs one.
class Server {
 public:
  Server() {
    fast_dds::dds::DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(
        std::make_shared<fast_dds::transport::UDPv4TransportDescriptor>());
    fast_dds::fastrtps::get_server_client_default_guidPrefix(1, qos.wire_protocol().prefix);
    auto& builtin = qos.wire_protocol().builtin;
    builtin.discovery_config.discoveryProtocol = fast_dds::fastrtps::DiscoveryProtocol::SERVER;
    builtin.metatrafficUnicastLocatorList.push_back(fast_dds::locator("127.0.0.1", port_));
    server_ = fast_dds::dds::DomainParticipantFactory::get_instance()->create_participant(0, qos);
    if (server_ == nullptr) throw std::runtime_error("no server");
    setenv("ROS_DISCOVERY_SERVER", (";127.0.0.1:" + std::to_string(port_)).c_str(), 1);
  }
  ~Server() {
    // Fast DDS remembers the last value of a variable that is not set any more: later participants of this process would
    // still ask the server (2.9, ros_discovery_server_env()).
    setenv("ROS_DISCOVERY_SERVER", "", 1);
    fast_dds::dds::DomainParticipantFactory::get_instance()->delete_participant(server_);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

 private:
  const std::uint16_t port_ = free_port();
  fast_dds::dds::DomainParticipant* server_ = nullptr;
};

// A node of the robot: Fast DDS itself reads ROS_DISCOVERY_SERVER, as it does for rmw_fastrtps.
class RobotNode {
 public:
  explicit RobotNode(const TestDomain& domain)
      : context_(domain.options()),
        node_(*context_, {"/", "driver"}),
        publisher_(std::move(
            *RawPublisher::create(node_, "~/scan", msg::Float64::kType, rtps::qos::kDefault))) {}

 private:
  LiveContext context_;
  NodeEntry node_;
  std::unique_ptr<RawPublisher> publisher_;
};

TEST(DiscoveryServer, TellsUsOfAllThatItKnows) {
  const TestDomain domain;
  const Server server;
  ParticipantOptions options = domain.options();
  options.servers = options_from_environment()->servers;
  ASSERT_EQ(options.servers.size(), 1u);
  LiveContext culprit(options);
  {
    const RobotNode before(domain);
    EXPECT_TRUE(culprit.sees_endpoint("/driver", EndpointKind::kPublisher, "/driver/scan"));
  }
  EXPECT_TRUE(culprit.sees_node_leave("/driver"));
  const RobotNode later(domain);
  LiveContext late(options);
  EXPECT_TRUE(late.sees_endpoint("/driver", EndpointKind::kPublisher, "/driver/scan"));
}

}  // namespace
}  // namespace culprit::ros2
