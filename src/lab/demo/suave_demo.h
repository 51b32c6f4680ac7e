// A live SUAVE with culprit managing it, in a world of its own: its own DDS domain on loopback, its
// own state folder, and nothing left behind.
//
// The robot is a handful of processes (exemplars/suave) and `culprit modes`, which changes their
// modes; the water gets murky and a thruster fails, and in the extended mission the battery runs
// low. There culprit also starts anew what dies.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "demo/episode.h"
#include "exemplars/suave/mission_observer.h"
#include "live/live_session.h"
#include "plan/paper_planner.h"
#include "ros2/domain_lock.h"

namespace culprit::lab {

struct MissionOutcome {
  suave::MissionSeen mission;
  std::vector<std::string> failures;    // in the order of their detection
  std::vector<std::string> strategies;  // in the order of their execution
  std::vector<double> reaction_times;   // of resolved failures, seconds on the clock
  std::size_t unresolved = 0;
};

class SuaveDemo : private live::Listener {
 public:
  struct Options {
    bool is_extended = false;
    double speed = 1;  // robot seconds in a second
    std::uint64_t seed = 1;
    std::optional<std::uint32_t> domain{};  // nothing: one that is free
    PlannerFactory planner = [] { return std::make_unique<PaperPlanner>(); };
    // Called for each event of the manager, on its thread, with its time since the start.
    std::function<void(const Event&, const RuleSet&, Time start)> on_event;
  };

  // Starts the processes and the manager. Sets variables of this process's environment, so call it
  // before there are threads that read it. Errors: a program is missing.
  static Expected<std::unique_ptr<SuaveDemo>> start(Options options, const std::atomic<bool>& stop);
  // Ends every process and removes the state folder, unless keep_state() was called.
  ~SuaveDemo() override;

  // Waits until the mission is over. An error: it does not begin, does not end, or `stop` was set.
  Expected<MissionOutcome> fly();

  const std::filesystem::path& keep_state();
  std::uint32_t domain() const { return domain_.domain(); }

 private:
  SuaveDemo(Options options, const std::atomic<bool>& stop, ros2::DomainLock domain,
            std::filesystem::path state);
  Expected<void> open();
  Expected<void> start_processes();
  void on_event(const Event& event, const RuleSet& rules, Time start) override;

  Options options_;
  const std::atomic<bool>& stop_;
  ros2::DomainLock domain_;
  const std::filesystem::path state_;
  bool keeps_state_ = false;
  const RuleSet rules_;  // as they are managed by

  RuleSet processes_;  // as components of their own: what is managed are their nodes
  Inbox processes_inbox_;
  std::unique_ptr<owners::Supervisor> supervisor_;
  std::unique_ptr<suave::MissionObserver> observer_;
  live::OrderKeeper keeper_;
  live::LiveSession::Options how_;
  std::unique_ptr<live::LiveSession> session_;  // null: the robot was not joined

  Mutex mutex_;
  Episode episode_ CULPRIT_GUARDED_BY(mutex_);

  std::thread thread_;  // runs the session
};

}  // namespace culprit::lab
