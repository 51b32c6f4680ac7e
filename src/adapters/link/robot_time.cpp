#include "link/robot_time.h"

#include <ctime>
#include <utility>

#include "base/live_clock.h"

namespace culprit::link {

Expected<void> RobotTime::open() {
  auto clock = SimulatedClock::open(self_);
  if (!clock) return Error{clock.error()};
  clock_ = std::move(*clock);
  made_ = clock_.get();
  return {};
}

Expected<void> RobotTime::follow_for_all() {
  is_for_all_ = true;
  return open();
}

void RobotTime::learned(ComponentId component, const std::string& node, bool is_simulated) {
  if (!is_simulated) {
    is_mixed_ = true;
    hold(node, false);
    simulated_.erase(node);
    return;
  }
  simulated_.try_emplace(node, Simulated{component});
  if (clock_) return;
  if (auto opened = open(); !opened) return inbox_.put(LinkTrouble{opened.error()});
  first_ = node;
  first_since_ = live_now();
  constexpr Duration kLooks = std::chrono::milliseconds(50);
  looking_ = std::make_unique<ros2::Timer>(context_.executor(), kLooks, [this] { look(); });
}

// Null: it is followed for none, or for those nodes only that use it.
const SimulatedClock* RobotTime::clock_of_all() const {
  const SimulatedClock* made = made_;
  const bool is_followed = made != nullptr && (is_for_all_ || made->has_begun());
  return is_followed && !is_mixed_ ? made : nullptr;
}

Time RobotTime::doubtful(Time now) const {
  const SimulatedClock* clock = clock_of_all();
  return clock == nullptr ? kNever : clock->doubtful(now);
}

void RobotTime::look() {
  for (const auto& [writer, node] : context_.graph().publishers_of(SimulatedClock::kTopic)) {
    if (simulated_.contains(node)) sources_.insert(node);
  }
  if (!sources_.empty()) is_mixed_ = true;  // its publisher does not wait for it
  const Time now = live_now();
  const bool is_held = clock_of_all() == nullptr && stands_still(now);
  for (const auto& [node, simulated] : simulated_) hold(node, is_held && !sources_.contains(node));
  if (clock_->has_begun()) report_pause(is_held, now);
}

bool RobotTime::stands_still(Time now) {
  if (clock_->doubtful(now) <= now) stood_ = now;
  return now < later(stood_, SimulatedClock::kAfterJump);
}

void RobotTime::hold(const std::string& node, bool is_held) {
  const auto known = simulated_.find(node);
  if (known == simulated_.end() || known->second.is_held == is_held) return;
  known->second.is_held = is_held;
  inbox_.put(TimeHeld{known->second.component, is_held});
}

// A short pause, as at a jump, is none to speak of.
void RobotTime::report_pause(bool is_held, Time now) {
  constexpr Duration kLong = std::chrono::seconds(2);
  if (!is_held) runs_ = now;
  const bool is_long = is_held && (told_of_pause_ || now > later(runs_, kLong));
  if (std::exchange(told_of_pause_, is_long) == is_long) return;
  inbox_.put(LinkTrouble{is_long
                             ? "the simulated time stands still: culprit judges nothing about its "
                               "nodes until it goes on"
                             : "the simulated time goes on"});
}

void RobotTime::report() {
  report_step();
  if (!first_.empty() && !told_of_clock_) report_clock();
}

void RobotTime::report_step() {
  timespec steady{};
  clock_gettime(CLOCK_BOOTTIME, &steady);
  const Duration running =
      std::chrono::seconds(steady.tv_sec) + std::chrono::nanoseconds(steady.tv_nsec);
  const auto step = system_clock_.look(running, Duration(wall_now()));
  if (step) inbox_.put(ClockStepped{*step});
}

void RobotTime::report_clock() {
  constexpr Duration kClockComes = std::chrono::seconds(10);
  const std::string whose = first_ + " uses simulated time (use_sim_time)";
  if (clock_->has_begun()) {
    told_of_clock_ = true;
    inbox_.put(LinkTrouble{whose + ": culprit follows /clock, and judges nothing about such nodes "
                                   "while that stands still or jumps"});
  } else if (!told_of_no_clock_ && live_now() > later(first_since_, kClockComes)) {
    told_of_no_clock_ = true;
    const bool has_source = !context_.graph().publishers_of(SimulatedClock::kTopic).empty();
    inbox_.put(LinkTrouble{
        whose +
        (has_source ? ", and /clock has not ticked yet" : ", and no node publishes /clock") +
        ": its timers stand still, and culprit judges nothing about such nodes. " +
        (has_source ? "Let the simulation run"
                    : "Start the simulation, or set use_sim_time to false")});
  }
}

}  // namespace culprit::link
