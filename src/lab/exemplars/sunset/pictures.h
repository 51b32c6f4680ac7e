// Pictures on the wire: sensor_msgs/Image in the exemplar's encodings, rows without padding.
//
//     RgbImage    bgr8
//     DepthImage  16UC1, little endian
//     LabelImage  8UC1
//
// A picture of 0 x 0 stands for none, in any encoding. Another encoding or an incomplete message
// gives an empty result: any publisher may send it.
#pragma once

#include <optional>

#include "exemplars/sunset/image.h"
#include "ros2/messages.h"

namespace culprit::sunset {

ros2::msg::Image to_message(const RgbImage& picture, const ros2::msg::Header& header);
ros2::msg::Image to_message(const DepthImage& picture, const ros2::msg::Header& header);
ros2::msg::Image to_message(const LabelImage& picture, const ros2::msg::Header& header);

std::optional<RgbImage> rgb_of(const ros2::msg::Image& message);
std::optional<DepthImage> depth_of(const ros2::msg::Image& message);
// The labels may be out of their range.
std::optional<LabelImage> labels_of(const ros2::msg::Image& message);

}  // namespace culprit::sunset
