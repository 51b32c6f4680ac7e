// Reads the log of components out of /rosout: the lines that rules count with logs(). Lines may arrive 100 ms late, as
// diagnostics do (diagnostics_watch.h).
//
// A line counts for the component whose node owns its writer, whatever name it is signed with. A line whose writer no node
// claims yet waits until one does, for kClaimed at most.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/log_level.h"
#include "base/mutex.h"
#include "base/time.h"
#include "inbox/inbox.h"
#include "language/rule_set.h"
#include "link/waiting_lines.h"
#include "ros2/subscription.h"

namespace culprit::link {

// By component: the least level of the lines that rules count; empty: they count none.
std::vector<std::optional<LogLevel>> counted_log_levels(const RuleSet& rules);

class LogWatch {
 public:
  // Subscribes if a rule counts lines. All references must outlive the watch. `component_of` is called on the
  // executor's thread.
  using ComponentOf = std::function<std::optional<ComponentId>(const std::string& node)>;
  static Expected<std::unique_ptr<LogWatch>> create(ros2::NodeEntry& self, const RuleSet& rules,
                                                    Inbox& inbox, ComponentOf component_of);

 private:
  static constexpr Duration kClaimed = std::chrono::seconds(5);
  static constexpr Duration kRetry = std::chrono::milliseconds(200);
  static constexpr std::size_t kMostWaiting = 1000;

  LogWatch(ros2::NodeEntry& self, const RuleSet& rules, Inbox& inbox, ComponentOf component_of);
  void on_sample(const ros2::Sample& sample);
  void look_up();

  ros2::NodeEntry& self_;
  Inbox& inbox_;
  const ComponentOf component_of_;
  const std::vector<std::optional<LogLevel>> wanted_;
  LogLevel least_ = LogLevel::kFatal;
  Mutex mutex_;  // receive threads take it: nothing of the middleware is called with it
  WaitingLines waiting_ CULPRIT_GUARDED_BY(mutex_){kMostWaiting};
  bool is_posted_ CULPRIT_GUARDED_BY(mutex_) = false;  // look_up()
  ros2::TaskGroup tasks_;                              // outlives the one that posts to it
  std::unique_ptr<ros2::RawSubscription> subscription_;
};

}  // namespace culprit::link
