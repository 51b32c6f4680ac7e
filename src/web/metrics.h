// culprit's own metrics in Prometheus' text format 0.0.4; the names follow
// prometheus.io/docs/practices. docs/web.md lists it.
//
// The manager's thread counts; any thread may read. Counting a step in which nothing happened is a
// handful of atomic additions, and no reader can hold the manager up: what it copies under the lock
// is bounded by the rule set.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "base/mutex.h"
#include "manager/manager.h"

namespace culprit::web {

class Metrics {
 public:
  // Upper bounds of the histogram of step times, in seconds.
  static constexpr std::array<double, 12> kStepBounds = {
      0.00005, 0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 1};

  // All counters of `manager` exist from now on, at 0: a rate needs a beginning. Counters of a
  // previous manager go on.
  void watch(const Manager& manager);
  // Must be called after each step of `manager`, with its duration.
  void stepped(Duration took, std::size_t observations, const Manager& manager);

  // `dropped` returns how many datagrams were dropped because their sender was not the participant that they claim; it is called from now on. Empty: it cannot
  // be called any more, and its last value stays.
  void count_dropped(std::function<std::uint64_t()> dropped);

  // From any thread.
  std::uint64_t steps() const { return steps_; }
  // The robot had its time to show itself.
  bool is_discovered() const { return is_discovered_; }
  // The robot can be heard.
  bool hears() const { return hears_; }
  // All of it, with what the operating system says of this process.
  std::string text() const;

 private:
  using Series = std::map<std::string, std::uint64_t>;  // by labels: rule="CameraSilent"
  struct Counts {
    Series detected;
    Series resolved;
    Series exhausted;
    Series plans;
    Series strategies;
    Series holds;
    Series orders;
    Series open;
    Series blind;
    Series components;
    std::string info;
    std::size_t approvals_pending = 0;
    std::size_t silences = 0;
    bool is_paused = false;
    bool is_dry_run = false;
    bool is_storm = false;
  };

  static void count(const Event& event, const RuleSet& rules, Counts& counts);
  static void look(const Manager& manager, Counts& counts);
  std::string step_times() const;

  std::array<std::atomic<std::uint64_t>, kStepBounds.size() + 1> step_times_{};  // by bucket
  std::atomic<std::uint64_t> steps_ = 0;
  std::atomic<std::uint64_t> step_nanoseconds_ = 0;
  std::atomic<std::uint64_t> observations_ = 0;
  std::atomic<bool> is_discovered_ = false;
  std::atomic<bool> hears_ = true;

  mutable Mutex dropped_mutex_;  // another one: what is called takes a lock
  std::function<std::uint64_t()> dropped_ CULPRIT_GUARDED_BY(dropped_mutex_);
  std::uint64_t dropped_before_ CULPRIT_GUARDED_BY(dropped_mutex_) =
      0;  // by those that can be asked no more

  mutable Mutex mutex_;
  Counts counts_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::web
