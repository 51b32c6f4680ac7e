// The processes of the rover: `rover-node NAME` runs one of them.
//
//   world ─ hardware ─> lidar_driver, camera_driver, imu_driver, base_driver
//   camera_driver ─> cloud_maker, both in perception_container
//   map_server, lidar_driver ─> amcl ─> /tf ─> planner_server, controller_server
//   bt_navigator ─ actions ─> planner_server, controller_server, behavior_server
//   controller_server, behavior_server ─> velocity_smoother ─> twist_mux ─> base_driver
//   e_stop ─ lock ─> twist_mux
//
// The world and the mission, which gives the goals, are no part of the robot.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "exemplars/rover/rover_node.h"

namespace culprit::rover {

struct Process {
  std::string_view name;
  std::unique_ptr<RoverNode> (*make)(Settings);  // null: a lifecycle manager
  bool is_robot = true;
  bool is_composed = false;  // loaded by perception_container; without culprit on its own
};

template <class Node>
std::unique_ptr<RoverNode> make(Settings settings) {
  return std::make_unique<Node>(std::move(settings));
}

extern const Process kWorld, kMission;
extern const Process kEkf;  // a fault
extern const Process kLidarDriver, kCameraDriver, kImuDriver, kBaseDriver, kMapServer, kAmcl;
extern const Process kPerceptionContainer, kCloudMaker;
extern const Process kPlannerServer, kControllerServer, kBehaviorServer, kBtNavigator;
extern const Process kVelocitySmoother, kTwistMux, kEStop;

// In the order in which they are started; without kEkf.
std::span<const Process> processes();

// The servers of the lifecycle managers, in the order of start-up.
inline constexpr std::string_view kLocalization[] = {"/map_server", "/amcl"};
inline constexpr std::string_view kNavigation[] = {"/controller_server", "/planner_server",
                                                   "/behavior_server", "/velocity_smoother",
                                                   "/bt_navigator"};
// Whether one of these is of that full name.
bool is_server(std::string_view node);

// The process of a lifecycle manager as Nav2's (bond_manager.h): opens its node, and works for ever on a thread of its own, which
// the process must not wait for. Its node has parameters and answers while the manager is blocked.
Expected<void> run_lifecycle_manager(ros2::Context& context, const std::string& name,
                                     std::span<const std::string_view> servers);

}  // namespace culprit::rover
