#include "web/usage_history.h"

#include <algorithm>

#include "web/hub_observer.h"

namespace culprit::web {
namespace {

bool may_change_processes(const Observation& observation) {
  const auto& what = observation.what;
  return std::holds_alternative<ProcessSeen>(what) || std::holds_alternative<NodeAppeared>(what) ||
         std::holds_alternative<NodeVanished>(what);
}

}  // namespace

std::optional<ProcessStat> UsageHistory::stat_of_pid(int pid) {
  return process_stat(std::to_string(pid));
}

UsageHistory::~UsageHistory() {
  {
    const MutexLock lock(mutex_);
    is_over_ = true;
  }
  ends_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void UsageHistory::start() {
  try {
    thread_ = std::thread([this] { look_again_and_again(); });
  } catch (const std::system_error&) {
    return;
  }
}

void UsageHistory::look_again_and_again() {
  for (;;) {
    look(HubObserver::wall_clock());
    MutexLock lock(mutex_);
    if (ends_.wait_for(lock, kPeriod, [&]() CULPRIT_REQUIRES(mutex_) { return is_over_; })) return;
  }
}

void UsageHistory::look(double clock) {
  std::map<int, std::optional<ProcessStat>> stats;
  {
    const MutexLock lock(mutex_);
    for (const auto& [component, process] : processes_) stats[process.pid];
  }
  // Without the lock, which the manager's thread takes, too.
  for (auto& [pid, stat] : stats) {
    if (pid != 0) stat = stat_(pid);
  }
  const MutexLock lock(mutex_);
  for (auto& [component, process] : processes_) add(process, stats[process.pid], clock);
}

// The oldest look becomes part of its minute.
void UsageHistory::age(Process& process) {
  constexpr double kMinute = 60;  // s
  const Usage oldest = process.usage.front();
  process.usage.pop_front();
  if (process.minutes.empty() || oldest.clock >= process.minutes.back().clock + kMinute) {
    process.minutes.push_back(oldest);
    if (process.minutes.size() > kMinutes) process.minutes.pop_front();
    return;
  }
  Usage& minute = process.minutes.back();
  minute.processor = std::max(minute.processor, oldest.processor);
  minute.memory = std::max(minute.memory, oldest.memory);
}

void UsageHistory::add(Process& process, const std::optional<ProcessStat>& stat, double clock) {
  if (!stat) {
    process.clock = 0;
    return;
  }
  // The clock on the wall may be set back, and the number of a process be another's by now.
  const double used = seconds(stat->processor) - process.processor_seconds;
  if (process.clock > 0 && clock > process.clock && used >= 0)
    process.usage.push_back({clock, used / (clock - process.clock), stat->resident_bytes});
  if (process.usage.size() > kMost) age(process);
  process.processor_seconds = seconds(stat->processor);
  process.clock = clock;
}

std::vector<UsageHistory::Usage> UsageHistory::of(const std::string& component) const {
  const MutexLock lock(mutex_);
  const auto found = processes_.find(component);
  if (found == processes_.end()) return {};
  return {found->second.usage.begin(), found->second.usage.end()};
}

std::vector<UsageHistory::Usage> UsageHistory::day_of(const std::string& component) const {
  const MutexLock lock(mutex_);
  const auto found = processes_.find(component);
  if (found == processes_.end()) return {};
  std::vector<Usage> all(found->second.minutes.begin(), found->second.minutes.end());
  all.insert(all.end(), found->second.usage.begin(), found->second.usage.end());
  return all;
}

void UsageHistory::begins(const Manager& manager, std::function<Remarks()>, Time) {
  manager_ = &manager;
  const RuleSet& rules = manager.knowledge().rules;
  {
    const MutexLock lock(mutex_);
    std::map<std::string, Process> all;  // what the rules still name keeps its past
    for (const Component& component : rules.components)
      all[component.name] = std::move(processes_[component.name]);
    processes_ = std::move(all);
  }
  take_pids();
}

void UsageHistory::stepped(const Runtime::Step& step) {
  if (std::any_of(step.observations.begin(), step.observations.end(), may_change_processes))
    take_pids();
}

void UsageHistory::take_pids() {
  const Knowledge& knowledge = manager_->knowledge();
  const MutexLock lock(mutex_);
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const auto& component = knowledge.rules.components[c];
    const int pid = component.host().empty() ? knowledge.components[ComponentId(c)].known_pid() : 0;
    Process& process = processes_[component.name];
    if (process.pid != pid) process.clock = 0;
    process.pid = pid;
  }
}

}  // namespace culprit::web
