// Observes a live mission: when the pipeline was found, how much of it was inspected, when the
// mission was over.
//
// A node of its own on a thread of its own; it touches nothing. Times are robot seconds since the
// mission began.
#pragma once

#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "exemplars/suave/live_names.h"
#include "ros2/node.h"

namespace culprit::suave {

struct MissionSeen {
  bool has_begun = false;
  std::optional<double> found_s;  // the search time
  double inspected_m = 0;
  std::optional<double> done_s;
};

class MissionObserver {
 public:
  static Expected<std::unique_ptr<MissionObserver>> start(
      double speed, const ros2::ParticipantOptions& participant);
  ~MissionObserver();

  // From any thread.
  MissionSeen seen() const;

 private:
  explicit MissionObserver(double speed) : speed_(speed) {}
  Expected<void> open(const ros2::ParticipantOptions& participant);
  Expected<void> subscribe();
  double robot_s() const CULPRIT_REQUIRES(mutex_);

  const double speed_;
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  mutable Mutex mutex_;
  std::optional<ros2::Executor::Clock::time_point> begun_ CULPRIT_GUARDED_BY(mutex_);
  MissionSeen seen_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
  std::thread thread_;
};

}  // namespace culprit::suave
