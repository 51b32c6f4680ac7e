// A live rover in a world of its own, with culprit managing it, or another manager beside Nav2's own: its own DDS domain on
// loopback, its own state folder, and nothing left behind.
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
#include "demo/play_outcome.h"
#include "exemplars/rover/experiment.h"
#include "live/live_session.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/domain_lock.h"

namespace culprit::lab {

class RoverDemo : private live::Listener {
 public:
  // The manager that keeps the rover working, besides Nav2's lifecycle managers, which are always there.
  enum class Manager : std::uint8_t {
    kNone,
    kRespawn,  // each process that exits is started again after 2 s
    kCulprit
  };

  struct Options {
    std::uint64_t seed = 1;
    std::optional<std::uint32_t> domain{};  // nothing: one that is free
    Manager manager = Manager::kCulprit;
    PlannerFactory planner = [] { return std::make_unique<BayesPlanner>(); };
    // Called for each event of the manager, on its thread, with its time since the start of the demo.
    std::function<void(const Event&, const RuleSet&, Time start)> on_event{};
    // Observes the demo, and must outlive it; null: none.
    live::Observer* observer = nullptr;
  };

  // Starts all processes and waits until the rover drives. Sets ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and what the nodes read of
  // this process, so call it before there are threads that read the environment. Errors: a program is missing, or the
  // robot does not come up.
  static Expected<std::unique_ptr<RoverDemo>> start(Options options, const std::atomic<bool>& stop);
  // Ends every process and removes the state folder, unless keep_state() was called.
  ~RoverDemo() override;

  // Breaks the rover, and waits until it drives again or `patience` is over. With a fault that only a person mends: until it
  // stands. Removes what is left of the faults. An error: a fault could not be injected, or `stop` was set.
  Expected<PlayOutcome> play(const rover::Play& play, Duration patience = kPatience);

  Expected<void> inject(const std::string& fault);
  Expected<void> clear_faults();
  rover::Measurements measure() const { return experiment_->measure(); }

  const std::filesystem::path& keep_state();
  // @pre managed by culprit
  const RuleSet& rules() const { return session_->rules(); }
  static const char* rule_text();
  std::uint32_t domain() const { return domain_.domain(); }
  live::OrderKeeper& keeper() { return keeper_; }
  void submit(Order order) { session_->submit(std::move(order)); }
  void interrupt() { session_->interrupt(); }

  static constexpr Duration kPatience = std::chrono::seconds(60);

 private:
  RoverDemo(Options options, const std::atomic<bool>& stop, ros2::DomainLock domain,
            std::filesystem::path state);
  Expected<void> open();
  Expected<void> inject(const rover::Play& play);
  Expected<void> open_session(const ros2::ParticipantOptions& participant);
  void respawn();
  ComponentId stray(const std::string& process) const;
  void on_event(const Event& event, const RuleSet& rules, Time start) override;
  // Gives when the rover was well, and stayed so for a moment. `faults` must be over, too.
  std::optional<Time> wait_until_well(const std::vector<const rover::Fault*>& faults,
                                      Duration patience);
  bool wait_for_safe_stop();

  Options options_;
  const std::atomic<bool>& stop_;
  ros2::DomainLock domain_;
  const std::filesystem::path state_;
  bool keeps_state_ = false;
  std::atomic<bool> is_over_ = false;

  // World, mission and a respawned process; without culprit the whole robot; and faults.
  RuleSet rules_of_processes_;
  Inbox processes_inbox_;
  std::unique_ptr<owners::Supervisor> processes_;
  std::unique_ptr<rover::Experiment> experiment_;
  live::OrderKeeper keeper_;
  live::LiveSession::Options how_;
  std::unique_ptr<live::LiveSession> session_;  // null: without culprit

  mutable Mutex mutex_;
  std::optional<Episode> episode_ CULPRIT_GUARDED_BY(mutex_);

  std::thread thread_;     // runs the session
  std::thread respawner_;  // of a process that rover.rules declares so; as a manager, of all
};

}  // namespace culprit::lab
