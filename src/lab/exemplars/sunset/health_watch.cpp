#include "exemplars/sunset/health_watch.h"

namespace culprit::sunset {
namespace {

constexpr double kLongestGapSec = 0.5;

std::string text(double value) { return std::to_string(value).substr(0, 5); }

}  // namespace

HealthWatch::HealthWatch(Time begin, Duration robot_second)
    : calm_(from_seconds(kCalmSec * seconds(robot_second))),
      longest_gap_(from_seconds(kLongestGapSec * seconds(robot_second))),
      last_segmentation_(begin),
      last_gap_(begin) {}

void HealthWatch::on_state(Member member, std::optional<LifecycleState> state) {
  states_[static_cast<std::size_t>(member)] = state;
}

void HealthWatch::on_segmentation(Time at) {
  if (at - last_segmentation_ > longest_gap_) last_gap_ = at;
  last_segmentation_ = at;
}

void HealthWatch::on_entropy(double entropy, Time at) {
  if (entropy > kEntropyLimit) last_unsure_ = {at, entropy};
}

void HealthWatch::on_iou(double iou, Time at) {
  last_judgement_ = at;
  if (iou < kGoodIou) last_wrong_ = {at, iou};
}

std::string HealthWatch::complaint(Time now) const {
  for (const Member member : kManagedMembers) {
    if (member == Member::kImageEnhancement) continue;
    const auto& state = states_[static_cast<std::size_t>(member)];
    if (!state) return std::string(name_of(member)) + " does not answer";
    if (*state != LifecycleState::kActive) {
      return std::string(name_of(member)) + " is " + std::string(ros2::label_of(*state));
    }
  }
  if (now - last_segmentation_ > longest_gap_) {
    return "no segmentation for " + text(seconds(now - last_segmentation_)) + " s";
  }
  if (is_blurred_) return "the camera is out of focus";
  if (last_unsure_ && is_recent(last_unsure_->at, now)) {
    return "the segmentation is unsure: entropy " + text(last_unsure_->value);
  }
  if (last_wrong_ && is_recent(last_wrong_->at, now)) {
    return "the segmentation is wrong: IoU " + text(last_wrong_->value);
  }
  if (!last_judgement_ || !is_recent(*last_judgement_, now)) return "the evaluator says nothing";
  if (is_recent(last_gap_, now)) return "the segmentation has only just come back";
  return "";
}

}  // namespace culprit::sunset
