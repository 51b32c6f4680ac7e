// Reads the rules' signals out of /diagnostics. Messages may arrive 100 ms late (participant.h):
// many nodes repeat there what has not changed.
//
// A status counts only from its publisher (signal_publishers.h). The watch looks up the node of a writer once, on the
// executor's thread, where the writer's first message waits for that; and again when nodes came or
// went.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include "base/mutex.h"
#include "inbox/inbox.h"
#include "link/diagnostics_reading.h"
#include "link/signal_publishers.h"
#include "link/waiting_lookups.h"
#include "ros2/subscription.h"

namespace culprit::link {

class DiagnosticsWatch {
 public:
  // Subscribes if the rules read any diagnostic. All references must outlive the watch.
  // `component_of` is called on the executor's thread.
  using ComponentOf = std::function<std::optional<ComponentId>(const std::string& node)>;
  static Expected<std::unique_ptr<DiagnosticsWatch>> create(ros2::NodeEntry& self,
                                                            const RuleSet& rules, Inbox& inbox,
                                                            ComponentOf component_of);

  // An earlier run learned which node publishes that status. From any thread.
  void remember(const std::string& status, const std::string& node);

  // On the executor's thread.
  void node_joined(const std::string& node);
  void node_left(const std::string& node);
  // Statuses that several nodes publish, in words. From any thread.
  std::map<std::string, std::string> conflicts() const;

 private:
  // Bytes of the messages of writers that are looked up.
  static constexpr std::size_t kMostWaiting = ros2::msg::DiagnosticArray::kLargest;

  DiagnosticsWatch(ros2::NodeEntry& self, const RuleSet& rules, Inbox& inbox,
                   ComponentOf component_of);
  bool is_wanted() const;
  void on_sample(const ros2::Sample& sample);
  void look_up(const rtps::Guid& writer, std::size_t size, WaitingLookups::Room room,
               const ros2::msg::DiagnosticArray& message);
  void read(const ros2::msg::DiagnosticArray& message, const SignalPublishers::Publisher& by)
      CULPRIT_REQUIRES(mutex_);
  bool may_say(const std::string& status, std::optional<ComponentId> publisher,
               const SignalPublishers::Publisher& by) CULPRIT_REQUIRES(mutex_);
  void on_level(DiagnosticId diagnostic, std::uint8_t level) CULPRIT_REQUIRES(mutex_);
  void on_signal(SignalId signal, const std::string& text) CULPRIT_REQUIRES(mutex_);

  ros2::NodeEntry& self_;
  Inbox& inbox_;
  mutable Mutex mutex_;  // receive threads take it: nothing of the middleware is called with it
  DiagnosticsReading reading_ CULPRIT_GUARDED_BY(mutex_);
  SignalPublishers publishers_ CULPRIT_GUARDED_BY(mutex_);
  const ComponentOf component_of_;
  std::set<std::string> nodes_ CULPRIT_GUARDED_BY(mutex_);  // of the graph
  std::unordered_map<rtps::Guid, SignalPublishers::Publisher> writers_
      CULPRIT_GUARDED_BY(mutex_);  // that were looked up
  // Those that no node claims: when each was looked up first.
  std::unordered_map<rtps::Guid, Time> unclaimed_ CULPRIT_GUARDED_BY(mutex_);
  WaitingLookups waiting_ CULPRIT_GUARDED_BY(mutex_){kMostWaiting};
  // The newest values, by signal and by diagnostic.
  std::unordered_map<std::uint32_t, std::string> last_ CULPRIT_GUARDED_BY(mutex_);
  std::unordered_map<std::uint32_t, std::uint8_t> last_level_ CULPRIT_GUARDED_BY(mutex_);
  ros2::TaskGroup tasks_;  // outlives the one that posts to it
  std::unique_ptr<ros2::RawSubscription> subscription_;
};

}  // namespace culprit::link
