#include "simulation/fault.h"

namespace culprit::simulation {
namespace {

void strike(Node& node, const BadParameter& fault) {
  node.post([&node, fault] { node.set_parameter(fault.name, fault.value); });
}
void strike(Node& node, const Killed& fault) {
  node.fail_starts(fault.failing_starts);
  node.kill();
}
void strike(Node& node, const Stopped&) { node.stop(); }
void strike(Node& node, const Continued&) { node.resume(); }
void strike(Node& node, const Hung&) { node.hang(); }
void strike(Node&, const Impaired&) {}

}  // namespace

Expected<void> inject(World& world, const Fault& fault) {
  if (const auto* impaired = std::get_if<Impaired>(&fault.what)) {
    TopicBase* topic = world.topic(impaired->topic);
    if (topic == nullptr) return Error{"the robot has no topic " + impaired->topic};
    world.at(fault.at,
             [topic, transport = impaired->transport] { topic->set_transport(transport); });
    return {};
  }
  Node* node = world.node(fault.node);
  if (node == nullptr) return Error{"the robot has no node " + fault.node};
  if (const auto* bad = std::get_if<BadParameter>(&fault.what); bad && !node->has(bad->name))
    return Error{fault.node + " has no parameter " + bad->name};
  world.at(fault.at, [node, what = fault.what] {
    std::visit([node](const auto& each) { strike(*node, each); }, what);
  });
  return {};
}

}  // namespace culprit::simulation
