// All leaves of this package, for programs that link it:
//
//     BT::BehaviorTreeFactory factory;
//     culprit_bt::register_nodes(factory);
//     auto blackboard = BT::Blackboard::create();
//     blackboard->set<rclcpp::Node::SharedPtr>("node", node);
//     BT::Tree tree = factory.createTreeFromFile("mission.xml", blackboard);
//
// The same from the plugin: factory.registerFromPlugin(".../libculprit_bt_nodes.so").
#pragma once

#include "behaviortree_cpp/bt_factory.h"
#include "culprit_bt/incident.h"
#include "culprit_bt/is_healthy.h"
#include "culprit_bt/request_mode.h"
#include "culprit_bt/wait_for_recovery.h"

namespace culprit_bt {

inline void register_nodes(BT::BehaviorTreeFactory& factory) {
  factory.registerNodeType<Incident>("Incident");
  factory.registerNodeType<IsHealthy>("IsHealthy");
  factory.registerNodeType<RequestMode>("RequestMode");
  factory.registerNodeType<WaitForRecovery>("WaitForRecovery");
}

}  // namespace culprit_bt
