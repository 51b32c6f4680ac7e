// The processes of the rover: `rover-node NAME` runs one of them.
//
//   world ─ hardware ─> lidar_driver, camera_driver, imu_driver, base_driver
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

std::unique_ptr<RoverNode> make_world(Settings settings);
std::unique_ptr<RoverNode> make_mission(Settings settings);
std::unique_ptr<RoverNode> make_lidar_driver(Settings settings);
std::unique_ptr<RoverNode> make_camera_driver(Settings settings);
std::unique_ptr<RoverNode> make_imu_driver(Settings settings);
std::unique_ptr<RoverNode> make_base_driver(Settings settings);
std::unique_ptr<RoverNode> make_map_server(Settings settings);
std::unique_ptr<RoverNode> make_amcl(Settings settings);
std::unique_ptr<RoverNode> make_planner_server(Settings settings);
std::unique_ptr<RoverNode> make_controller_server(Settings settings);
std::unique_ptr<RoverNode> make_behavior_server(Settings settings);
std::unique_ptr<RoverNode> make_bt_navigator(Settings settings);
std::unique_ptr<RoverNode> make_velocity_smoother(Settings settings);
std::unique_ptr<RoverNode> make_twist_mux(Settings settings);
std::unique_ptr<RoverNode> make_e_stop(Settings settings);

struct Process {
  std::string_view name;
  std::unique_ptr<RoverNode> (*make)(Settings);  // null: a lifecycle manager
  bool is_robot = true;
};

// In the order in which they are started.
std::span<const Process> processes();

// The servers of the lifecycle managers, in the order of start-up.
inline constexpr std::string_view kLocalization[] = {"/map_server", "/amcl"};
inline constexpr std::string_view kNavigation[] = {"/controller_server", "/planner_server",
                                                   "/behavior_server", "/velocity_smoother",
                                                   "/bt_navigator"};

}  // namespace culprit::rover
