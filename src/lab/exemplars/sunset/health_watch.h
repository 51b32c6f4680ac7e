// Whether the pipeline is well, as far as the experimenter can see, and has been for a while.
//
// It is well if all nodes but image_enhancement are active (that one may be or not), and the camera
// does not call its pictures blurred. In addition, during the last kCalmSec robot seconds,
// segmentations came without a gap, all of them sure, and right as far as the evaluator judged
// them.
//
// A pure data structure, told what happens.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "base/time.h"
#include "exemplars/sunset/members.h"
#include "ros2/lifecycle.h"

namespace culprit::sunset {

inline constexpr double kEntropyLimit = 0.06;  // the published one
inline constexpr double kGoodIou =
    0.47;  // 6000 healthy frames had 0.54 and more, bad ones 0.42 at most
inline constexpr double kCalmSec = 1.5;

class HealthWatch {
 public:
  // A robot second takes `robot_second`; watching begins at `begin`.
  HealthWatch(Time begin, Duration robot_second);

  // Times do not decrease.
  void on_state(Member member, std::optional<LifecycleState> state);  // nothing: no answer
  void on_segmentation(Time at);
  void on_entropy(double entropy, Time at);
  void on_iou(double iou, Time at);
  void on_autofocus(bool is_needed) { is_blurred_ = is_needed; }

  // Why the pipeline is not well, for people; empty if it is.
  std::string complaint(Time now) const;

 private:
  // Something that should not have been.
  struct Blemish {
    Time at;
    double value = 0;
  };
  bool is_recent(Time at, Time now) const { return now - at <= calm_; }

  Duration calm_;
  Duration longest_gap_;
  std::array<std::optional<LifecycleState>, kMembers.size()> states_{};
  Time last_segmentation_;
  Time last_gap_;  // its end
  std::optional<Time> last_judgement_;
  std::optional<Blemish> last_unsure_;
  std::optional<Blemish> last_wrong_;
  bool is_blurred_ = false;
};

}  // namespace culprit::sunset
