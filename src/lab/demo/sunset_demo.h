// A live SUNSET in a world of its own, with culprit managing it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "base/mutex.h"
#include "demo/episode.h"
#include "demo/play.h"
#include "demo/play_outcome.h"
#include "demo/sunset_world.h"
#include "live/live_session.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::lab {

class SunsetDemo : private live::Listener {
 public:
  struct Options {
    double speed = 1;  // robot seconds in a second
    std::uint64_t seed = 1;
    std::optional<std::uint32_t> domain{};  // nothing: one that is free
    PlannerFactory planner = [] { return std::make_unique<BayesPlanner>(); };
    // Called for each event of the manager, on its thread, with its time since the start of the
    // demo.
    std::function<void(const Event&, const RuleSet&, Time start)> on_event{};
    // Observes the demo, and must outlive it; null: none.
    live::Observer* observer = nullptr;
  };

  // Starts the seven processes and the manager and waits until the robot is well. Sets
  // ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY of this process, so call it before there are threads that
  // read the environment. Errors: a program is missing, or the robot does not come up.
  static Expected<std::unique_ptr<SunsetDemo>> start(Options options,
                                                     const std::atomic<bool>& stop);
  // Ends every process and removes the state folder, unless keep_state() was called.
  ~SunsetDemo() override;

  // Breaks the robot, waits until it is well again or kPatience is over, and then removes what is
  // left of the faults. An error: a fault could not be injected, the robot cannot be made well
  // between plays, or `stop` was set.
  Expected<PlayOutcome> play(const Play& play);

  // The faults that the browser can inject: those of the scenarios, and processes that are killed
  // or stopped ("kill:camera").
  Expected<void> inject(const std::string& fault);
  // Removes what was injected. Does not wait until the robot is well.
  Expected<void> clear_faults() { return world_->experiment().clear(); }

  const std::filesystem::path& keep_state() { return world_->keep_state(); }
  const RuleSet& rules() const { return session_->rules(); }
  // The file that they are of.
  static const char* rule_text();
  std::uint32_t domain() const { return world_->domain(); }
  // Keeps nothing, and says so.
  live::OrderKeeper& keeper() { return keeper_; }
  // Gives the manager an order, or has it look round. From any thread.
  void submit(Order order) { session_->submit(std::move(order)); }
  void interrupt() { session_->interrupt(); }

 private:
  static constexpr Duration kPatience = std::chrono::seconds(90);

  SunsetDemo(Options options, const std::atomic<bool>& stop);
  Expected<void> open();
  void on_event(const Event& event, const RuleSet& rules, Time start) override;
  Expected<void> inject(const Play& play);
  // Waits until the robot is well and no failure is open for a while. Gives whether that came to
  // be.
  bool wait_until_well(Duration patience);
  Expected<void> clear();

  Options options_;
  const std::atomic<bool>& stop_;
  std::unique_ptr<SunsetWorld> world_;
  live::OrderKeeper keeper_;
  live::LiveSession::Options how_;
  std::unique_ptr<live::LiveSession> session_;  // null: the robot was not joined

  Mutex mutex_;
  std::optional<Episode> episode_ CULPRIT_GUARDED_BY(mutex_);
  Time last_event_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;

  std::thread thread_;  // runs the session
};

}  // namespace culprit::lab
