// The adapter: a simulated world as a robot that a managing system watches and adapts.
//
// It reports the same observations as a live link: nodes, topics, samples and signals that the
// rules read, parameters, lifecycle, processes. It carries out requests, which take time to reach
// the node, wait for its executor, and take time to come back.
//
// A system of a mode manager is a component like a node: it is there as long as its manager is.
//
//     World world(seed);
//     MyCamera camera(world);                      // a Node (node.h)
//     SimulatedRobot robot(rules, world);
//     Runtime(manager, robot).run(stop, Time(60s));    // a minute, at once
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "language/rule_set.h"
#include "robot/component_binding.h"
#include "robot/robot.h"
#include "simulation/world.h"

namespace culprit::simulation {

class SimulatedRobot : public Robot, private Watcher {
 public:
  // Both must outlive the robot. Reports at once what is in the world already.
  SimulatedRobot(const RuleSet& rules, World& world);
  ~SimulatedRobot() override;

  Time now() const override { return world_.now(); }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

 private:
  void on_node(const Node& node, bool is_there) override;
  void on_endpoint(const Node& node, EndpointKind kind, const std::string& name,
                   bool is_there) override;
  void on_sample(const TopicBase& topic) override;
  void on_field(const TopicBase& topic, const std::string& field, const Value& value) override;
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override;
  void on_level(std::string_view status, std::uint8_t level) override;
  void on_parameter(const Node& node, const std::string& name, const Value& value) override;
  void on_lifecycle(const Node& node) override;
  void on_process(const Node& node, const std::string& remark) override;

  void index_rules();
  std::optional<ComponentId> component_of(const Node& node);
  void tell_systems(const Node& manager, bool is_there);
  void tell_signals(const std::string& name, const Value& value);
  Node* node_of(ComponentId component) const;
  Node* server_of(const Command& command) const;
  void request(const Command& command, Node& node);
  void serve(const Command& command, Node& node);
  void serve_modes(const Command& command, Node& node);
  void answer(const Command& command, Node& node, Outcome outcome,
              decltype(Reply::value) value = {}, std::string text = "");
  void reply(CommandId command, Outcome outcome, decltype(Reply::value) value = {},
             std::string text = "");

  template <class What>
  void tell(What what) {
    inbox_.push_back({world_.now(), std::move(what)});
  }

  const RuleSet& rules_;
  World& world_;
  ComponentBinding binding_;
  std::map<const Node*, ComponentId> components_;
  std::map<std::string, TopicId, std::less<>> topics_;
  std::map<std::string, std::vector<SignalId>, std::less<>> signals_;  // by source + '\n' + key
  std::set<CommandId> open_;  // requests that were not answered yet
  std::vector<Observation> inbox_;
};

}  // namespace culprit::simulation
