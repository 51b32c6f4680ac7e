// A live SUNSET in a world of its own: its own DDS domain on loopback, its own state folder, and
// nothing left behind. Who manages it is up to others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

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

  // Starts the seven processes; `rules` must outlive the world. Sets ROS_DOMAIN_ID,
  // ROS_LOCALHOST_ONLY and what the nodes read of this process, so there is one world in a process,
  // and it comes before there are threads that read the environment. Errors: there is no domain
  // left, or no folder can be made.
  static Expected<std::unique_ptr<SunsetWorld>> start(const Options& options, const RuleSet& rules);
  // Ends every process and removes the state folder, unless keep_state() was called. Whoever drives
  // the robot has ended before.
  ~SunsetWorld();

  LiveRobot& robot() { return *robot_; }
  sunset::Experiment& experiment() { return *experiment_; }
  std::uint32_t domain() const { return domain_.domain(); }
  const std::filesystem::path& keep_state();

 private:
  explicit SunsetWorld(ros2::DomainLock domain);
  Expected<void> open(const Options& options, const RuleSet& rules);

  ros2::DomainLock domain_;
  std::filesystem::path state_;
  bool keeps_state_ = false;

  // The bag player and the evaluator: processes that nobody manages.
  RuleSet extras_rules_;
  Inbox extras_inbox_;
  std::unique_ptr<owners::Supervisor> extras_;

  std::unique_ptr<LiveRobot> robot_;
  std::unique_ptr<sunset::Experiment> experiment_;
};

}  // namespace culprit::lab
