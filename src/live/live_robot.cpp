#include "live/live_robot.h"

#include <algorithm>

namespace culprit {

Expected<std::unique_ptr<LiveRobot>> LiveRobot::open(const RuleSet& rules, Options options) {
  std::unique_ptr<LiveRobot> robot(new LiveRobot(rules));
  robot->supervisor_ =
      std::make_unique<owners::Supervisor>(rules, std::move(options.supervisor), robot->inbox_);
  auto link = ros2::Link::open(rules, std::move(options.link), robot->inbox_);
  if (!link) return Error{link.error()};
  robot->link_ = std::move(*link);
  return robot;
}

void LiveRobot::observe(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  listen(until, observations);
  witness(before, observations);
  // A component whose process was found is watched from now on, whoever started it.
  for (std::size_t i = before; i < observations.size(); ++i) {
    const auto* appeared = std::get_if<NodeAppeared>(&observations[i].what);
    if (appeared == nullptr || appeared->pid == 0) continue;
    if (const auto component = binding_.bind(appeared->node))
      supervisor_->adopt(*component, appeared->pid, observations[i].at);
  }
}

// Until then, or until it becomes doubtful whether anything is heard, or no longer is. Between two
// heartbeats there is nothing to tell.
void LiveRobot::listen(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  while (true) {
    const Time now = live_now();
    const bool hears = link_->doubtful() > now;
    if (hears == deaf_since_.has_value()) return inbox_.take(now, observations);
    const Time look = hears ? link_->doubtful() : later(now, ros2::Hearing::kPeriod);
    inbox_.take(std::min(until, look), observations);
    const bool was_woken = observations.size() > before || live_now() < std::min(until, look);
    if (was_woken || live_now() >= until) return;
  }
}

// What silence means is clear before anything that was observed is judged.
void LiveRobot::witness(std::size_t before, std::vector<Observation>& observations) {
  const Time now = live_now();
  const bool hears = link_->doubtful() > now;
  if (hears == !deaf_since_) return;
  Observation observation{now, HearingRegained{}};
  if (!hears) {
    observation.what = HearingLost{link_->doubt()};
    deaf_since_ = now;
  } else {
    deaf_since_.reset();
  }
  observations.insert(observations.begin() + static_cast<std::ptrdiff_t>(before),
                      std::move(observation));
}

void LiveRobot::execute(const Command& command) {
  if (std::holds_alternative<StopProcess>(command.what)) {
    const Adaptation& what =
        rules_[command.purpose.strategy].adaptations[command.purpose.adaptation];
    const bool is_replaced = what.type == AdaptationType::kRedeploy;
    supervisor_->stop(command.id, command.component,
                      is_replaced ? owners::Ending::kToStartAgain : owners::Ending::kForGood);
  } else if (std::holds_alternative<StartProcess>(command.what)) {
    supervisor_->start(command.id, command.component);
  } else {
    link_->execute(command);
  }
}

}  // namespace culprit
