#include "link/log_watch.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "base/live_clock.h"
#include "ros2/messages.h"

namespace culprit::link {

std::vector<std::optional<LogLevel>> counted_log_levels(const RuleSet& rules) {
  std::vector<std::optional<LogLevel>> levels(rules.components.size());
  for (const Input& input : rules.inputs) {
    if (input.kind != Input::Kind::kLogs) continue;
    std::optional<LogLevel>& level = levels[input.component.index];
    level = std::min(level.value_or(input.log_level), input.log_level);
  }
  return levels;
}

Expected<std::unique_ptr<LogWatch>> LogWatch::create(ros2::NodeEntry& self, const RuleSet& rules,
                                                     Inbox& inbox, ComponentOf component_of) {
  std::unique_ptr<LogWatch> watch(new LogWatch(self, rules, inbox, std::move(component_of)));
  const auto is_counted = [](const auto& level) { return level.has_value(); };
  if (std::ranges::none_of(watch->wanted_, is_counted)) return watch;
  // Best effort: a reader that is late must not hold a node back that logs.
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
  auto subscription = ros2::RawSubscription::create(
      self, "/rosout", ros2::msg::Log::kType, kQos, ros2::PayloadUse::kWholeLater,
      [raw = watch.get()](const ros2::Sample& sample) { raw->on_sample(sample); });
  if (!subscription) return Error{subscription.error()};
  watch->subscription_ = std::move(*subscription);
  return watch;
}

LogWatch::LogWatch(ros2::NodeEntry& self, const RuleSet& rules, Inbox& inbox,
                   ComponentOf component_of)
    : self_(self),
      inbox_(inbox),
      component_of_(std::move(component_of)),
      wanted_(counted_log_levels(rules)),
      tasks_(self.context().executor()) {
  for (const auto& level : wanted_) least_ = std::min(level.value_or(least_), least_);
}

void LogWatch::on_sample(const ros2::Sample& sample) {
  // culprit's own messages are not read.
  const rtps::Guid writer = sample.identity.writer;
  if (writer.prefix() == self_.context().participant().guid().prefix()) return;
  const auto line = rtps::decode<ros2::msg::Log>(sample.payload);
  if (!line) return;
  const LogLevel level = log_level(line->level);
  if (level < least_) return;
  const MutexLock lock(mutex_);
  waiting_.add({writer, level, live_now()});
  if (std::exchange(is_posted_, true)) return;
  tasks_.post([this] { look_up(); });
}

void LogWatch::look_up() {
  std::deque<WaitingLines::Line> lines;
  {
    const MutexLock lock(mutex_);
    lines = waiting_.take();
    is_posted_ = false;
  }
  const Time now = live_now();
  std::deque<WaitingLines::Line> unclaimed;
  for (const WaitingLines::Line& line : lines) {
    const ros2::Graph::Owner owner = self_.context().graph().owner_of(line.writer);
    if (owner.node.empty()) {
      if (now < later(line.at, kClaimed)) unclaimed.push_back(line);
      continue;
    }
    const auto component = owner.counts ? component_of_(owner.node) : std::nullopt;
    const auto wanted = component ? wanted_[component->index] : std::nullopt;
    if (wanted && line.level >= *wanted) inbox_.put(LogSeen{*component, line.level});
  }
  if (unclaimed.empty()) return;
  const MutexLock lock(mutex_);
  for (const WaitingLines::Line& line : unclaimed) waiting_.add(line);
  if (std::exchange(is_posted_, true)) return;
  tasks_.post_at(ros2::Executor::Clock::now() + kRetry, [this] { look_up(); });
}

}  // namespace culprit::link
