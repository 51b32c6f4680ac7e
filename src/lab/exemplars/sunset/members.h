// The seven processes of the live robot: who they are, and the topics between them.
//
//     world --> camera --> (image_enhancement) --> sensor_fusion --> segmentation --> evaluator
//        |---> depth ------------------------------^                                   ^
//        |-----------------------------------------------------------------------------|
//
// Names are the exemplar's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "ros2/names.h"

namespace culprit::sunset {

// The five in the middle are managed; the world plays the bag, the evaluator is the experimenter's.
enum class Member : std::uint8_t {
  kWorld,
  kCamera,
  kDepth,
  kImageEnhancement,
  kSensorFusion,
  kSegmentation,
  kEvaluator
};

inline constexpr std::array kMembers = {
    Member::kWorld,        Member::kCamera,       Member::kDepth,    Member::kImageEnhancement,
    Member::kSensorFusion, Member::kSegmentation, Member::kEvaluator};
inline constexpr std::array kManagedMembers = {Member::kCamera, Member::kDepth,
                                               Member::kImageEnhancement, Member::kSensorFusion,
                                               Member::kSegmentation};

inline constexpr std::string_view kManagedNamespace = "/managed_subsystem";
inline constexpr std::string_view kExperimentNamespace = "/experiment_setup";

// What sunset-node takes: "camera".
constexpr std::string_view name_of(Member member) {
  constexpr std::array<std::string_view, kMembers.size()> kNames = {
      "world",         "camera",       "depth",    "image_enhancement",
      "sensor_fusion", "segmentation", "evaluator"};
  return kNames[static_cast<std::size_t>(member)];
}

inline ros2::NodeName node_of(Member member) {
  switch (member) {
    case Member::kWorld:
      return {"/", "rosbag2_player"};
    case Member::kEvaluator:
      return {std::string(kExperimentNamespace), std::string(name_of(member))};
    default:
      return {std::string(kManagedNamespace), std::string(name_of(member))};
  }
}

namespace topics {

inline constexpr std::string_view kRgbRaw = "/rgb_raw";
inline constexpr std::string_view kDepthRaw = "/depth_raw";
inline constexpr std::string_view kTruth = "/gt_segmentation";
inline constexpr std::string_view kRgbCamera = "/managed_subsystem/rgb_camera";
inline constexpr std::string_view kRgbEnhanced = "/managed_subsystem/rgb_enhanced";
inline constexpr std::string_view kDepthCamera = "/managed_subsystem/depth_camera";
inline constexpr std::string_view kSensorsFused = "/managed_subsystem/sensors_fused";
inline constexpr std::string_view kSegmentation = "/managed_subsystem/segmentation";
inline constexpr std::string_view kDiagnostics = "/diagnostics";
inline constexpr std::string_view kIou = "/experiment_setup/iou";
inline constexpr std::string_view kVehicleIou = "/experiment_setup/vehicle_iou";
inline constexpr std::string_view kRoadIou = "/experiment_setup/road_iou";

}  // namespace topics

}  // namespace culprit::sunset
