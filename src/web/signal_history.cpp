#include "web/signal_history.h"

#include <cmath>
#include <limits>

#include "knowledge/describe.h"

namespace culprit::web {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
constexpr double kSilentAfter = 3;  // usual intervals

float plotted_value(const Slot& slot, const Input& input) {
  if (!slot.known) return kNoValue;
  switch (input.type) {
    case Type::kBool:
      return slot.b ? 1 : 0;
    case Type::kDuration:
      return static_cast<float>(seconds(Duration(slot.i)));
    case Type::kInt:
      return static_cast<float>(slot.i);
    case Type::kString:
      return kNoValue;
    default:
      return std::isfinite(slot.d) ? static_cast<float>(slot.d) : kNoValue;
  }
}

}  // namespace

void SignalHistory::begins(const Manager& manager, std::function<Remarks()>, Time) {
  manager_ = &manager;
  const RuleSet& rules = manager.knowledge().rules;
  std::vector<std::string> names;
  for (const Topic& topic : rules.topics) {
    names.push_back("rate " + topic.name);
    names.push_back("age " + topic.name);
  }
  for (const Input& input : rules.inputs) names.push_back("input " + describe(input, rules));
  const MutexLock lock(mutex_);
  std::map<std::string, std::deque<float>> all;
  for (const std::string& name : names) {
    auto& values = all[name];
    if (const auto before = values_.find(name); before != values_.end())
      values = std::move(before->second);
    values.resize(clocks_.size(), kNoValue);
  }
  values_ = std::move(all);
  in_order_.clear();
  for (const std::string& name : names) in_order_.push_back(&values_[name]);
  next_ = kLongAgo;
}

void SignalHistory::stepped(const Runtime::Step& step) {
  if (!is_sampling_ || step.now < next_) return;
  next_ = later(step.now, kPeriod);
  sample();
}

void SignalHistory::sample() {
  const Knowledge& knowledge = manager_->knowledge();
  const RuleSet& rules = knowledge.rules;
  const MutexLock lock(mutex_);
  std::size_t place = 0;
  const auto add = [&]() CULPRIT_REQUIRES(mutex_) -> std::deque<float>& {
    return *in_order_[place++];
  };
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(TopicId(t));
    const double age = rhythm.last ? seconds(knowledge.now - *rhythm.last) : kNoValue;
    const double interval = seconds(rhythm.interval);
    const bool is_silent = rhythm.last && age > kSilentAfter * interval;
    add().push_back(interval <= 0 ? kNoValue : is_silent ? 0 : static_cast<float>(1 / interval));
    add().push_back(static_cast<float>(age));
  }
  for (std::size_t i = 0; i < rules.inputs.size(); ++i)
    add().push_back(plotted_value(knowledge.signals[InputId(i)], rules.inputs[i]));
  clocks_.push_back(wall_());
  if (clocks_.size() <= kMost) return;
  clocks_.pop_front();
  for (auto& [name, values] : values_) values.pop_front();
}

Series SignalHistory::of(const std::string& name) const {
  const MutexLock lock(mutex_);
  const auto found = values_.find(name);
  if (found == values_.end()) return {};
  return {{clocks_.begin(), clocks_.end()}, {found->second.begin(), found->second.end()}};
}

}  // namespace culprit::web
