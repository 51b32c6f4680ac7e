// What sensor_fusion publishes: SUNSET's own message type, which no distribution knows.
//
// Names and order of the fields as in the exemplar's package system_interfaces; that its fusion
// type is one byte is our guess.
#pragma once

#include <cstdint>
#include <string_view>

#include "ros2/messages.h"

namespace culprit::sunset {

struct FusionType {
  static constexpr std::string_view kType = "system_interfaces/msg/FusionType";
  static constexpr std::uint8_t kFusion = 0;
  static constexpr std::uint8_t kRgb = 1;
  static constexpr std::uint8_t kDepth = 2;

  std::uint8_t fusion_type = kFusion;
  static void visit(auto& self, auto& each) { each(self.fusion_type); }
};

// The picture of a modality that is not in use is empty.
struct FusedMessage {
  static constexpr std::string_view kType = "system_interfaces/msg/SensorFusion";

  ros2::msg::Image depth;
  ros2::msg::Image rgb;
  FusionType modality;
  ros2::msg::Header header;
  static void visit(auto& self, auto& each) {
    each(self.depth, self.rgb, self.modality, self.header);
  }
};

}  // namespace culprit::sunset
