// The newest transforms from map to odom and from odom to base_link, as they come on /tf.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "exemplars/rover/geometry.h"

namespace culprit::rover {

class TfBuffer {
 public:
  // Older ones are taken for none (transform_tolerance).
  static constexpr double kTolerance = 1;  // seconds

  void add(const msg::TFMessage& message) {
    for (const msg::TransformStamped& each : message.transforms) all_[each.child_frame_id] = each;
  }
  // The pose of base_link.
  std::optional<Pose2> in_odom() const { return find("base_link"); }
  std::optional<Pose2> in_map() const {
    const auto odom = find("odom");
    const auto base = find("base_link");
    return odom && base ? std::optional(*odom * *base) : std::nullopt;
  }

 private:
  std::optional<Pose2> find(const char* child) const {
    const auto found = all_.find(child);
    if (found == all_.end()) return std::nullopt;
    const auto& [header, frame, transform] = found->second;
    const msg::Time now = header_now("").stamp;
    const double age = now.sec - header.stamp.sec +
                       (static_cast<double>(now.nanosec) - header.stamp.nanosec) * 1e-9;
    if (age > kTolerance) return std::nullopt;
    return Pose2{transform.translation.x, transform.translation.y, yaw_of(transform.rotation)};
  }

  std::map<std::string, msg::TransformStamped> all_;
};

}  // namespace culprit::rover
