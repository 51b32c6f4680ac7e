// A node of the robot's user, as rclcpp makes one: it receives culprit's messages, and gives it
// orders.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ros2/live_test.h"
#include "ros2/service_client.h"
#include "ros2/subscription.h"
#include "ros_api/message_codec.h"

namespace culprit::ros_api {

class TestRosNode {
 public:
  explicit TestRosNode(const ros2::ParticipantOptions& options)
      : context(options), node_(*context, {"/", "panel"}) {}

  // Every message of the topic from now on, and with `latched` the newest before.
  rtps::EventLog<Json>& hear(const std::string& topic, const std::string& type,
                             rtps::Durability durability = rtps::Durability::kVolatile);

  // Waits until that node knows all readers of this one. False: it does not answer.
  bool is_known_to(const std::string& node);

  // The answer of a service; null: there was none in time.
  Json call(const std::string& service, const std::string& type, const Json& request,
            Duration patience = rtps::kPatience);
  // The same, of any bytes.
  Json call_with(const std::string& service, const std::string& type, const rtps::Bytes& request,
                 Duration patience = rtps::kPatience);

  // A client of a service of culprit's node, which has no namespace. It sends a request once, when
  // the server has proven that it knows the client: so no order is given twice.
  std::unique_ptr<ros2::ServiceClient> client_of(const std::string& service,
                                                 const std::string& type);

  const CulpritTypes types;
  ros2::LiveContext context;

 private:
  ros2::NodeEntry node_;
  std::vector<std::unique_ptr<rtps::EventLog<Json>>> logs_;
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
};

}  // namespace culprit::ros_api
