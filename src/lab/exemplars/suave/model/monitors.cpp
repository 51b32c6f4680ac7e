#include "exemplars/suave/model/monitors.h"

#include <algorithm>

#include "exemplars/suave/model/visibility.h"

namespace culprit::suave::model {
namespace {

constexpr Duration kPeriod = std::chrono::seconds(1);

// Calls `each` once a second from the mission's begin on; `phase` is below a second.
Duration first_tick(const Autopilot& autopilot, Time now, double phase) {
  return autopilot.guided() - now + from_seconds(phase);
}

}  // namespace

VisibilityMonitor::VisibilityMonitor(simulation::World& world, const Autopilot& autopilot,
                                     const MissionPlan& plan)
    : Node(world, nodes::kVisibility, {}), autopilot_(autopilot), plan_(plan) {}

void VisibilityMonitor::on_start() {
  every(first_tick(autopilot_, world().now(), random().uniform()), kPeriod, [this] {
    const auto second =
        std::chrono::floor<std::chrono::seconds>(world().now() - autopilot_.guided()).count();
    world().diagnose(diagnostics::kVisibility, diagnostics::kVisibilityKey,
                     water_visibility(second, plan_.visibility_period_s, plan_.visibility_shift_s,
                                      plan_.least_visibility_m, plan_.most_visibility_m));
  });
}

BatteryMonitor::BatteryMonitor(simulation::World& world, Topics& topics, Autopilot& autopilot,
                               const MissionPlan& plan)
    : Node(world, nodes::kBattery, {}),
      autopilot_(autopilot),
      plan_(plan),
      recharged_(*this, topics.recharged, simulation::Use::kAlways) {}

void BatteryMonitor::on_start() {
  every(first_tick(autopilot_, world().now(), random().uniform()), kPeriod,
        [this] { discharge(); });
}

void BatteryMonitor::discharge() {
  constexpr double kDischargeSec = 200;
  level_ = std::max(0.0, level_ - 1 / kDischargeSec);
  if (level_ == 0) {
    ran_empty_ = true;
    if (plan_.stops_when_empty) autopilot_.vehicle().cut_power();
  }
  tell();
}

void BatteryMonitor::tell() {
  world().diagnose(diagnostics::kBattery, diagnostics::kBatteryKey, level_);
}

void BatteryMonitor::recharge() {
  level_ = 1;
  tell();
  recharged_.publish({true});
}

ThrusterMonitor::ThrusterMonitor(simulation::World& world, Autopilot& autopilot,
                                 const MissionPlan& plan)
    : Node(world, nodes::kThrusters, {}), autopilot_(autopilot), plan_(plan) {}

void ThrusterMonitor::on_start() {
  every(first_tick(autopilot_, world().now(), random().uniform()), kPeriod, [this] { check(); });
}

void ThrusterMonitor::check() {
  const auto elapsed =
      std::chrono::floor<std::chrono::seconds>(world().now() - autopilot_.guided());
  const auto& events = plan_.thruster_events;
  for (; next_ < events.size() && elapsed >= events[next_].at; ++next_) {
    const ThrusterEvent& event = events[next_];
    autopilot_.vehicle().set_failed(event.thruster, event.fails);
    const std::string key = std::string(diagnostics::kThrusterKey) + std::to_string(event.thruster);
    for (const char* value : {event.fails ? diagnostics::kFailed : diagnostics::kRecovered,
                              event.fails ? diagnostics::kError : diagnostics::kOk})
      world().diagnose(diagnostics::kThrusters, key, std::string(value));
    world().diagnose(diagnostics::kThrusters, event.fails ? 2 : 0);
  }
}

}  // namespace culprit::suave::model
