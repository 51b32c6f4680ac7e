// The experimenter's view of the live robot, and the figures computed from it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/expected.h"
#include "base/mutex.h"
#include "exemplars/sunset/downtime.h"
#include "exemplars/sunset/health_watch.h"
#include "exemplars/sunset/members.h"
#include "ros2/node.h"

namespace culprit::sunset {

// Since the last Observer::restart(), as a rule for one scenario. Times in robot seconds.
struct Measurements {
  int judged_frames = 0;
  std::optional<double> mean_iou;  // of the judged frames, as the exemplar has it; nothing if none
  // Downtime of the evaluator's output, by downtime.h: the exemplar's figure, and the honest one.
  double downtime_between_outputs_sec = 0;
  double downtime_sec = 0;
  std::optional<double> entropy;  // last heard of, as the manager hears it
  std::string complaint;          // why the robot is not well (health_watch.h); empty if it is
};

class Observer {
 public:
  // Listens through `node`, which outlives it. A robot second lasts `robot_second`.
  static Expected<std::unique_ptr<Observer>> create(ros2::Node& node, Duration robot_second);

  // From any thread.
  void restart();
  Measurements measure() const;
  void on_state(Member member, std::optional<LifecycleState> state);

 private:
  struct Figures {
    Downtime evaluator;
    int judged_frames = 0;
    double iou_sum = 0;
  };

  explicit Observer(Duration robot_second);
  Expected<void> open(ros2::Node& node);
  Figures fresh(Time now) const;

  void on_segmentation();
  void on_iou(double iou);
  void on_diagnostics(const ros2::msg::DiagnosticArray& array);
  void on_value(const std::string& hardware_id, const ros2::msg::KeyValue& value);

  const Duration robot_second_;
  mutable Mutex mutex_;
  HealthWatch health_ CULPRIT_GUARDED_BY(mutex_);
  Figures figures_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<double> entropy_ CULPRIT_GUARDED_BY(mutex_);

  std::unique_ptr<ros2::RawSubscription> segmentations_;
  std::unique_ptr<ros2::Subscription> ious_;
  std::unique_ptr<ros2::Subscription> diagnostics_;
};

}  // namespace culprit::sunset
