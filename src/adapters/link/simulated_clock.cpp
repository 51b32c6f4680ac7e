#include "link/simulated_clock.h"

#include <algorithm>

#include "base/live_clock.h"
#include "ros2/messages.h"

namespace culprit::link {

Expected<std::unique_ptr<SimulatedClock>> SimulatedClock::open(ros2::NodeEntry& self) {
  auto clock = std::make_unique<SimulatedClock>();
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 1};
  // A message of this type is one builtin_interfaces/Time.
  auto subscription = ros2::RawSubscription::create(
      self, kTopic, "rosgraph_msgs/msg/Clock", kQos, ros2::PayloadUse::kWhole,
      [raw = clock.get()](const ros2::Sample& sample) {
        const auto time = rtps::decode<ros2::msg::Time>(sample.payload);
        if (time)
          raw->tick(std::chrono::seconds(time->sec) + std::chrono::nanoseconds(time->nanosec),
                    live_now());
      });
  if (!subscription) return Error{"cannot read /clock: " + subscription.error()};
  clock->subscription_ = std::move(*subscription);
  return clock;
}

void SimulatedClock::tick(Duration shown, Time now) {
  const MutexLock lock(mutex_);
  if (shown_ && shown == *shown_) return;  // repeated: it stands still
  if (shown_) {
    const Duration step = shown - *shown_;
    const Duration pause = std::min(now - advanced_, kPatienceAtMost);
    if (step < Duration{} || (step > kJump && step / kFastest > pause)) jumped_ = now;
    usual_pause_ += (pause - usual_pause_) / 8;
  }
  shown_ = shown;
  advanced_ = now;
}

bool SimulatedClock::has_just_jumped(Time now) const { return now < later(jumped_, kAfterJump); }

bool SimulatedClock::has_begun() const {
  const MutexLock lock(mutex_);
  return shown_.has_value();
}

Time SimulatedClock::doubtful(Time now) const {
  const MutexLock lock(mutex_);
  if (has_just_jumped(now)) return kLongAgo;
  return later(advanced_, std::clamp(3 * usual_pause_, kPatience, kPatienceAtMost));
}

std::string SimulatedClock::doubt(Time now) const {
  const MutexLock lock(mutex_);
  if (!shown_) return "culprit runs with --use-sim-time, and no node publishes /clock yet";
  return has_just_jumped(now) ? "the simulated time jumped" : "the simulated time stands still";
}

}  // namespace culprit::link
