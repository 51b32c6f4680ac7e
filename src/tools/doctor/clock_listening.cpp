#include "doctor/clock_listening.h"

#include "ros2/messages.h"

namespace culprit::doctor {

void ClockListening::listen() {
  if (subscription_) return;
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 1};
  // A message of this type is one builtin_interfaces/Time.
  auto subscription = ros2::RawSubscription::create(
      self_, "/clock", "rosgraph_msgs/msg/Clock", kQos, ros2::PayloadUse::kWhole,
      [this](const ros2::Sample& sample) { on_sample(sample); });
  if (subscription) subscription_ = std::move(*subscription);
}

void ClockListening::on_sample(const ros2::Sample& sample) {
  const auto time = rtps::decode<ros2::msg::Time>(sample.payload);
  if (!time) return;
  const Duration shown = std::chrono::seconds(time->sec) + std::chrono::nanoseconds(time->nanosec);
  const MutexLock lock(mutex_);
  if (!seen_) seen_ = SimulatedClock{0, shown, shown, 0};
  if (shown < seen_->last) ++seen_->jumps_back;
  ++seen_->ticks;
  seen_->last = shown;
}

void ClockListening::begin_anew() {
  const MutexLock lock(mutex_);
  if (seen_) seen_ = SimulatedClock{0, seen_->last, seen_->last, 0};
}

std::optional<Duration> ClockListening::now() const {
  const MutexLock lock(mutex_);
  return seen_ ? std::optional(seen_->last) : std::nullopt;
}

std::optional<SimulatedClock> ClockListening::seen() const {
  const MutexLock lock(mutex_);
  return seen_;
}

}  // namespace culprit::doctor
