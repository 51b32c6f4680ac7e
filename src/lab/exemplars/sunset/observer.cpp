#include "exemplars/sunset/observer.h"

#include <utility>

#include "base/value.h"
#include "exemplars/sunset/scene.h"
#include "inbox/inbox.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

Expected<std::unique_ptr<Observer>> Observer::create(ros2::Node& node, Duration robot_second) {
  std::unique_ptr<Observer> observer(new Observer(robot_second));
  if (auto opened = observer->open(node); !opened) return Error{opened.error()};
  return observer;
}

Observer::Observer(Duration robot_second)
    : robot_second_(robot_second), health_(live_now(), robot_second), figures_(fresh(live_now())) {}

Expected<void> Observer::open(ros2::Node& node) {
  // Only that it came: the pictures are the evaluator's business.
  auto segmentations = ros2::RawSubscription::create(
      node.entry(), topics::kSegmentation, msg::Image::kType, rtps::qos::kSensorData,
      ros2::PayloadUse::kHeader, [this](const ros2::Sample&) { on_segmentation(); });
  if (!segmentations) return Error{segmentations.error()};
  segmentations_ = std::move(*segmentations);
  auto ious = node.create_subscription<msg::Float64>(
      topics::kIou, rtps::qos::kDefault, [this](const msg::Float64& iou) { on_iou(iou.data); });
  if (!ious) return Error{ious.error()};
  ious_ = std::move(*ious);
  auto diagnostics = node.create_subscription<msg::DiagnosticArray>(
      topics::kDiagnostics, rtps::qos::kDefault,
      [this](const msg::DiagnosticArray& array) { on_diagnostics(array); });
  if (!diagnostics) return Error{diagnostics.error()};
  diagnostics_ = std::move(*diagnostics);
  return {};
}

Observer::Figures Observer::fresh(Time now) const {
  const Duration tolerated = from_seconds(2 * kFramePeriodSec * seconds(robot_second_));
  return {Downtime(now, tolerated)};
}

void Observer::restart() {
  const MutexLock lock(mutex_);
  figures_ = fresh(live_now());
}

Measurements Observer::measure() const {
  const auto robot_sec = [this](Duration wall) { return seconds(wall) / seconds(robot_second_); };
  const MutexLock lock(mutex_);
  const Time now = live_now();
  Measurements result;
  result.judged_frames = figures_.judged_frames;
  if (figures_.judged_frames > 0) result.mean_iou = figures_.iou_sum / figures_.judged_frames;
  result.downtime_between_outputs_sec = robot_sec(figures_.evaluator.between_outputs());
  result.downtime_sec = robot_sec(figures_.evaluator.total(now));
  result.entropy = entropy_;
  result.complaint = health_.complaint(now);
  return result;
}

void Observer::on_state(Member member, std::optional<LifecycleState> state) {
  const MutexLock lock(mutex_);
  health_.on_state(member, state);
}

void Observer::on_segmentation() {
  const MutexLock lock(mutex_);
  health_.on_segmentation(live_now());
}

void Observer::on_iou(double iou) {
  const MutexLock lock(mutex_);
  const Time now = live_now();
  health_.on_iou(iou, now);
  figures_.evaluator.on_output(now);
  figures_.iou_sum += iou;
  ++figures_.judged_frames;
}

void Observer::on_diagnostics(const msg::DiagnosticArray& array) {
  for (const msg::DiagnosticStatus& status : array.status) {
    for (const msg::KeyValue& value : status.values) on_value(status.hardware_id, value);
  }
}

void Observer::on_value(const std::string& hardware_id, const msg::KeyValue& value) {
  const Value read = value_from_text(value.value);
  const MutexLock lock(mutex_);
  if (hardware_id == name_of(Member::kSegmentation) && value.key == "entropy") {
    if (const auto* entropy = std::get_if<double>(&read)) {
      entropy_ = *entropy;
      health_.on_entropy(*entropy, live_now());
    }
  } else if (hardware_id == name_of(Member::kCamera) && value.key == "autofocus_needed") {
    if (const auto* is_needed = std::get_if<bool>(&read)) health_.on_autofocus(*is_needed);
  }
}

}  // namespace culprit::sunset
