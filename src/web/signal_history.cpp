#include "web/signal_history.h"

#include <limits>

#include "knowledge/plotted_values.h"

namespace culprit::web {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

}  // namespace

void SignalHistory::begins(const Manager& manager, std::function<Remarks()>, Time) {
  manager_ = &manager;
  const std::vector<std::string> names = plotted_names(manager.knowledge().rules);
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
  const std::vector<float> values = plotted_values(manager_->knowledge());
  const MutexLock lock(mutex_);
  for (std::size_t i = 0; i < values.size(); ++i) in_order_[i]->push_back(values[i]);
  clocks_.push_back(wall_());
  if (clocks_.size() <= kMost) return;
  clocks_.pop_front();
  for (auto& [name, kept] : values_) kept.pop_front();
}

Series SignalHistory::of(const std::string& name) const {
  const MutexLock lock(mutex_);
  const auto found = values_.find(name);
  if (found == values_.end()) return {};
  return {{clocks_.begin(), clocks_.end()}, {found->second.begin(), found->second.end()}};
}

}  // namespace culprit::web
