// A live SUNSET in a world of its own: its own DDS domain on loopback, its own state folder, and
// nothing left behind. Its manager is not part of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/invariant.h"
#include "exemplars/sunset/experiment.h"
#include "live/live_robot.h"
#include "ros2/domain_lock.h"

namespace culprit::lab {

class SunsetWorld {
 public:
  // How long a manager that is there from the beginning takes nothing for dead: the nodes are only
  // just being started.
  static constexpr Duration kStarting = std::chrono::seconds(20);
  // How long it may take until the robot is well for the first time.
  static constexpr Duration kPatience = std::chrono::seconds(60);

  struct Options {
    double speed = 1;  // robot seconds in a second
    std::uint64_t seed = 1;
    std::optional<std::uint32_t> domain{};  // nothing: one that is free
  };

  // Makes its domain and its folder. Sets ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and what the nodes read
  // of this process, so there is one world in a process, and it comes before there are threads that
  // read the environment. Errors: there is no domain left, or no folder can be made.
  static Expected<std::unique_ptr<SunsetWorld>> make(const Options& options);
  // Starts the seven processes. Those of the robot are the components of `rules` and belong to
  // `robot`, which must live until end(). Errors: the domain cannot be joined.
  Expected<void> begin(owners::Supervisor& robot, const RuleSet& rules);
  // Ends every process. The manager must have ended before.
  void end();
  // Ends every process, and removes the state folder unless keep_state() was called.
  ~SunsetWorld();

  // How the robot is joined. Errors: the environment is wrong.
  Expected<live::LiveRobot::Options> robot() const;
  // @pre begin() succeeded
  sunset::Experiment& experiment() {
    CULPRIT_ASSERT(experiment_);
    return *experiment_;
  }
  std::uint32_t domain() const { return domain_.domain(); }
  const std::filesystem::path& state() const { return state_; }
  const std::filesystem::path& keep_state();

 private:
  SunsetWorld(ros2::DomainLock domain, double speed, std::filesystem::path state);

  ros2::DomainLock domain_;
  const double speed_;
  const std::filesystem::path state_;
  bool keeps_state_ = false;

  // The bag player and the evaluator: processes without a manager.
  RuleSet extras_rules_;
  Inbox extras_inbox_;
  std::unique_ptr<owners::Supervisor> extras_;

  owners::Supervisor* robot_ = nullptr;  // null: nothing was started
  std::unique_ptr<sunset::Experiment> experiment_;
};

}  // namespace culprit::lab
