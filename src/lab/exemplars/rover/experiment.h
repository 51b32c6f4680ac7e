// The experimenter: breaks the live rover and measures what becomes of it. A node of its own on a thread of its own, which never
// repairs anything but in clear(). All members may be called from any thread.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/expected.h"
#include "base/mutex.h"
#include "exemplars/rover/faults.h"
#include "exemplars/rover/geometry.h"
#include "exemplars/sunset/node_control.h"
#include "ros2/node.h"
#include "ros2/options.h"
#include "ros2/timer.h"

namespace culprit::rover {

class Experiment {
 public:
  // `state`: of the rover's processes.
  static Expected<std::unique_ptr<Experiment>> start(const ros2::ParticipantOptions& participant,
                                                     std::filesystem::path state);
  ~Experiment();

  // @pre not Way::kStray. Blocks until the node has answered. An error: the fault is not in place, or we cannot tell.
  Expected<void> inject(const Fault& fault);
  // Whether the fault itself is over, whatever became of its effects. Blocks.
  bool is_over(const Fault& fault);
  // Removes all faults and the safe stop. The manager restarts exited processes and activates servers. Blocks.
  void clear();

  void restart_measuring();
  Measurements measure() const;

 private:
  Experiment(const ros2::ParticipantOptions& participant, std::filesystem::path state)
      : participant_(participant), state_(std::move(state)) {}
  Expected<void> open();
  std::filesystem::path next_start_of(const std::string& process) const {
    return state_ / ("next_" + process);
  }
  Expected<Value> parameter(const std::string& process, const std::string& name);
  sunset::NodeControl& control(const std::string& process) { return *controls_.at(process); }
  void on_truth(const msg::Odometry& truth);
  void on_diagnostics(const ros2::msg::DiagnosticArray& array);
  void poll_states();

  const ros2::ParticipantOptions participant_;
  const std::filesystem::path state_;
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::map<std::string, std::unique_ptr<sunset::NodeControl>> controls_;
  std::map<std::string, bool> is_polled_;
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
  std::optional<ros2::Timer> poll_;

  mutable Mutex mutex_;
  Measurements seen_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::string, std::optional<LifecycleState>> states_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<Pose2> robot_ CULPRIT_GUARDED_BY(mutex_);
  Pose2 moved_from_ CULPRIT_GUARDED_BY(mutex_);
  Time moved_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  Time last_truth_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;

  std::thread thread_;  // runs the executor
};

}  // namespace culprit::rover
