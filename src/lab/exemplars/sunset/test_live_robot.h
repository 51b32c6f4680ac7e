// The live robot for tests: the seven processes on a DDS domain of their own, an observer, and a
// client that adapts them through their services.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "base/test_folder.h"
#include "exemplars/sunset/members.h"
#include "exemplars/sunset/node_control.h"
#include "ros2/domain_lock.h"
#include "ros2/node.h"

namespace culprit::sunset {

// Counts messages, and follows what the heartbeats say.
class Watcher {
 public:
  explicit Watcher(const ros2::ParticipantOptions& participant);
  ~Watcher();

  NodeControl& control(Member member) { return *controls_[static_cast<std::size_t>(member)]; }

  // Each waits for an event, up to 30 s, and says whether it came.
  //
  // `messages` more on this topic.
  bool flows(std::string_view topic, int messages = 10);
  // No message on this topic while the world shows 10 more frames.
  bool falls_silent(std::string_view topic);
  // 30 more entropies in a row on one side of the limit.
  bool becomes_sure() { return has_in_a_row(&Watcher::sure_); }
  bool becomes_unsure() { return has_in_a_row(&Watcher::unsure_); }
  // The camera says so.
  bool says_autofocus(std::string_view text);

  // Whether a message came on this topic while the world showed 20 more frames.
  bool speaks_now(std::string_view topic);

 private:
  bool wait(const std::function<bool()>& condition);  // which is called with the mutex
  bool has_in_a_row(int Watcher::*count);
  void on_diagnostics(const ros2::msg::DiagnosticArray& array);

  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::array<std::unique_ptr<NodeControl>, kMembers.size()> controls_;
  Mutex mutex_;
  ConditionVariable something_came_;
  std::map<std::string_view, int> messages_ CULPRIT_GUARDED_BY(mutex_);
  int sure_ CULPRIT_GUARDED_BY(mutex_) = 0;  // in a row
  int unsure_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::string autofocus_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<ros2::RawSubscription>> subscriptions_;
  std::unique_ptr<ros2::Subscription> diagnostics_;
  std::thread thread_;
};

class LiveRobot {
 public:
  static constexpr double kSpeed = 2;

  // All processes are started; they end with this object, or with this process.
  LiveRobot();
  ~LiveRobot();

  const ros2::ParticipantOptions& participant() const { return participant_; }
  const std::filesystem::path& state() const { return state_; }
  Watcher& watcher() { return *watcher_; }

  int start(Member member);                        // its pid
  int end(Member member, int signal);              // its wait status, when it has ended
  std::optional<int> wait_for_end(Member member);  // nothing if it goes on for 30 s

  // Adaptations. An empty text: done; otherwise what went wrong.
  std::string set(Member member, const std::string& parameter, const Value& value);
  std::string change(Member member, ros2::TransitionId transition);
  std::string restart(Member member);
  void redeploy(Member member);

  std::optional<Value> get(Member member, const std::string& parameter);
  bool becomes(Member member, LifecycleState state);  // within 30 s

 private:
  ros2::DomainLock domain_;
  test::TestFolder own_;
  const std::filesystem::path state_ = own_.path();
  ros2::ParticipantOptions participant_;
  std::map<Member, int> pids_;
  std::optional<Watcher> watcher_;
};

}  // namespace culprit::sunset
