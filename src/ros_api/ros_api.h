// culprit's messages to ROS 2 nodes, and the orders that it takes from them: topics and services of
// culprit_msgs (ros/culprit_msgs) at culprit's own node.
//
//     ~/status         culprit_msgs/msg/Status    reliable, transient local, depth 1
//     ~/incidents      culprit_msgs/msg/Incident  reliable
//     ~/decisions      culprit_msgs/msg/Decision  reliable
//     ~/wait_for_recovery   culprit_msgs/action/WaitForRecovery
//     ~/pause, ~/resume, ~/approve, ~/silence, ~/run_strategy      if orders are taken;
//     ~/get_type_description    definitions of these types, as nodes of Jazzy and newer serve them
//
// The sessions of a run follow one another; each has a node of its own.
#pragma once

#include <array>
#include <optional>

#include "ros2/publisher.h"
#include "ros_api/order_services.h"
#include "ros_api/recovery_action.h"
#include "ros_api/teller.h"

namespace culprit::ros_api {

class RosApi : public live::Observer {
 public:
  struct Options {
    std::string version;  // of culprit
    // Takes orders; empty: none are taken.
    OrderServices::Give give{};
    // Called once for each node with the endpoints that could not be created, for example without
    // permissions. All else works without them.
    std::function<void(const std::string& trouble)> on_trouble = [](const std::string&) {};
  };

  explicit RosApi(Options options);

  void joined(ros2::NodeEntry& node) override;
  void leaves() override;
  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override {
    teller_.begins(manager, std::move(remarks), start);
  }
  void stepped(const Runtime::Step& step) override { teller_.stepped(step); }
  Time next_look() const override { return teller_.next_look(); }
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  struct Told {
    const MessageType* type = nullptr;
    std::unique_ptr<ros2::RawPublisher> publisher{};  // null: there is no node now, or it may not
  };

  Expected<void> offer(ros2::NodeEntry& node, Topic topic, std::string_view name,
                       const rtps::Qos& qos);
  Expected<void> describe_types(ros2::NodeEntry& node);
  void tell(Topic topic, const Json& message);

  const Options options_;
  const CulpritTypes types_;
  std::array<Told, 3> told_;  // by topic
  std::unique_ptr<ros2::ServiceServer> descriptions_;
  std::optional<OrderServices> orders_;
  RecoveryAction recovery_{types_};
  Teller teller_;
};

}  // namespace culprit::ros_api
