#include "cli/live_robot.h"

namespace culprit::cli {

Expected<std::unique_ptr<LiveRobot>> LiveRobot::open(const RuleSet& rules, Options options) {
  std::unique_ptr<LiveRobot> robot(new LiveRobot(rules));
  robot->supervisor_ =
      std::make_unique<process::Supervisor>(rules, std::move(options.supervisor), robot->inbox_);
  auto link = ros2::Link::open(rules, std::move(options.link), robot->inbox_);
  if (!link) return Error{link.error()};
  robot->link_ = std::move(*link);
  return robot;
}

void LiveRobot::observe(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  inbox_.take(until, observations);
  // A component whose process was found is watched from now on, whoever started it.
  for (std::size_t i = before; i < observations.size(); ++i) {
    const auto* appeared = std::get_if<NodeAppeared>(&observations[i].what);
    if (appeared == nullptr || appeared->pid == 0) continue;
    if (const auto component = binding_.bind(appeared->node))
      supervisor_->adopt(*component, appeared->pid, observations[i].at);
  }
}

void LiveRobot::execute(const Command& command) {
  if (std::holds_alternative<StopProcess>(command.what)) {
    const Adaptation& what =
        rules_[command.purpose.strategy].adaptations[command.purpose.adaptation];
    const bool is_replaced = what.type == AdaptationType::kRedeploy;
    supervisor_->stop(command.id, command.component,
                      is_replaced ? process::Ending::kToStartAgain : process::Ending::kForGood);
  } else if (std::holds_alternative<StartProcess>(command.what)) {
    supervisor_->start(command.id, command.component);
  } else {
    link_->execute(command);
  }
}

}  // namespace culprit::cli
