// The nodes, systems, topics and diagnostics of SUAVE, by their names in the exemplar.
#pragma once

#include <string_view>

#include "simulation/topic.h"

namespace culprit::suave::model {

namespace nodes {

inline constexpr const char* kAutopilot = "/mavros";
inline constexpr const char* kMission = "/mission_node";
inline constexpr const char* kModeManager = "/__mode_manager";
inline constexpr const char* kVisibility = "/water_visibility_observer_node";
inline constexpr const char* kBattery = "/battery_monitor";
inline constexpr const char* kThrusters = "/thruster_monitor";
inline constexpr const char* kDetector = "/pipeline_detection_wv";
inline constexpr const char* kSearch = "/f_generate_search_path_node";
inline constexpr const char* kFollow = "/f_follow_pipeline_node";
inline constexpr const char* kMotion = "/f_maintain_motion_node";
inline constexpr const char* kRecharge = "/generate_recharge_path_node";

}  // namespace nodes

// Each has one part, the node of its name.
namespace systems {

inline constexpr const char* kSearch = "/f_generate_search_path";
inline constexpr const char* kFollow = "/f_follow_pipeline";
inline constexpr const char* kMotion = "/f_maintain_motion";
inline constexpr const char* kRecharge = "/generate_recharge_path";

}  // namespace systems

namespace modes {

inline constexpr const char* kDefault = "__DEFAULT__";
inline constexpr const char* kOff = "fd_unground";  // of every system: inactive
inline constexpr const char* kFollow = "fd_follow_pipeline";
inline constexpr const char* kRecover = "fd_recover_thrusters";
inline constexpr const char* kAllThrusters = "fd_all_thrusters";
inline constexpr const char* kRecharge = "normal";
inline constexpr const char* kNoRecharge = "inactive";

}  // namespace modes

inline constexpr const char* kAltitude = "spiral_altitude";  // parameter of the search, m

namespace diagnostics {

inline constexpr std::string_view kVisibility =
    "water_visibility_observer: Water visibility measurement";
inline constexpr std::string_view kBattery = "battery_monitor: Battery level";
inline constexpr std::string_view kThrusters = "thruster_monitor: Thruster status";

inline constexpr std::string_view kVisibilityKey = "water_visibility";
inline constexpr std::string_view kBatteryKey = "battery_level";
inline constexpr std::string_view kThrusterKey = "c_thruster_";  // and its number, from 1

inline constexpr const char* kFailed = "FALSE";  // followed by
inline constexpr const char* kError = "ERROR";
inline constexpr const char* kRecovered = "RECOVERED";  // followed, if the monitor says it, by
inline constexpr const char* kOk = "OK";

}  // namespace diagnostics

// std_msgs/{Bool,Float32,String}: one field, "data".
struct Data {
  Value data;
};
std::optional<Value> field_of(const Data& message, std::string_view field);

struct Topics {
  explicit Topics(simulation::World& world);

  simulation::Topic<Data> guided;     // the autopilot takes setpoints
  simulation::Topic<Data> task;       // what the mission is at: "search", "inspect"
  simulation::Topic<Data> detected;   // the pipeline
  simulation::Topic<Data> distance;   // inspected since the following began, m
  simulation::Topic<Data> inspected;  // all of it
  simulation::Topic<Data> recharged;
};

}  // namespace culprit::suave::model
