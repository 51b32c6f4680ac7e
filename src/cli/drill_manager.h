// The culprit that heals while a drill injects faults: a `culprit run` of its own, followed over its local socket.
//
// It outlives a drill that is killed, so that it heals what the drill has broken.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <thread>

#include "base/mutex.h"
#include "cli/running_culprit.h"
#include "drill/injected.h"
#include "drill/robot_view.h"

namespace culprit::cli {

class DrillManager {
 public:
  // `arguments` as of culprit; its output goes to `log`. Calls `note` once it is a process, and then waits until it answers,
  // 60 s at most: if the drill is killed meanwhile, the next drill knows the process. Errors: it cannot be started, has
  // ended, or does not answer (its last line says why), or that of `note`.
  using Note = std::function<Expected<void>(const drill::ProcessId&)>;
  static Expected<std::unique_ptr<DrillManager>> start(const std::vector<std::string>& arguments,
                                                       const std::filesystem::path& log,
                                                       const std::atomic<bool>& stop,
                                                       const Note& note);
  // Ends it, unless leave() was called. The robot goes on.
  ~DrillManager();
  // Lets it run on after this object.
  void leave() { is_left_ = true; }

  const drill::ProcessId& process() const { return process_; }
  bool is_running() const;
  // Whether it runs and told something in the last 3 s.
  bool is_answering() const;
  // "culprit is paused"; empty: it acts on failures.
  std::string why_it_does_not_act() const;

  // As it was told last.
  drill::RobotView view() const;
  // Whether it ever detected a failure of this rule.
  bool has_detected(const std::string& rule) const;
  bool has_reloaded() const;
  // Events since that time on the clock, in seconds since 1970, oldest first.
  std::vector<Json> events_since(double clock) const;

 private:
  DrillManager(drill::ProcessId process, RunningCulprit culprit);
  void follow();
  void add_event(Json event) CULPRIT_REQUIRES(mutex_);

  const drill::ProcessId process_;
  const RunningCulprit culprit_;
  std::atomic<bool> is_over_ = false;
  bool is_left_ = false;

  mutable Mutex mutex_;
  Json robot_ CULPRIT_GUARDED_BY(mutex_);
  Json graph_ CULPRIT_GUARDED_BY(mutex_);
  Json state_ CULPRIT_GUARDED_BY(mutex_);
  Json control_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Json> events_ CULPRIT_GUARDED_BY(mutex_);
  std::set<std::string> detected_ CULPRIT_GUARDED_BY(mutex_);  // rules
  bool has_reloaded_ CULPRIT_GUARDED_BY(mutex_) = false;
  Time told_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;

  std::thread thread_;
};

// Ends the process if it is still the one that was meant: SIGINT, and SIGKILL after 5 s.
void end_manager(const drill::ProcessId& process);

// Now, in seconds since 1970.
double drill_clock();

}  // namespace culprit::cli
