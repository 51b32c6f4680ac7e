// Topics and services of the live robot that the model has no need of, and how its processes are
// started. The nodes' and the systems' names are the model's (model/members.h).
//
// The exemplar uses message types of its own and of MAVROS. The live robot uses those of std_msgs
// and std_srvs instead, so that every tool can read it without their packages.
#pragma once

#include <cstdint>

#include "base/units.h"
#include "rtps/qos.h"

namespace culprit::suave {

namespace topics {

inline constexpr const char* kPose = "/mavros/local_position/pose";
inline constexpr const char* kHome = "/mavros/home_position/home";  // the spiral's centre
inline constexpr const char* kSetpoint = "/mavros/setpoint_position/local";
inline constexpr const char* kFirstPoint =
    "/pipeline/first_point";  // number of the point seen first
inline constexpr const char* kDone = "/mission_node/done";
inline constexpr const char* kDiagnostics = "/diagnostics";

}  // namespace topics

namespace services {

inline constexpr const char* kStart = "/mavros/start";  // std_srvs/Trigger: the mission begins
inline constexpr const char* kRecharge = "/battery_monitor/recharge";

}  // namespace services

// Late joiners receive the last message.
inline constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal, .depth = 1};

inline constexpr const char* kModeMarker = "system_mode_marker";  // of nodes without parameters

struct NodeOptions {
  double speed = 1;  // robot seconds in a second, > 0
  std::uint64_t seed = 1;

  Duration wall(Duration robot) const { return from_seconds(seconds(robot) / speed); }
};

}  // namespace culprit::suave
