#include "exemplars/rover/nodes.h"

namespace culprit::rover {

std::span<const Process> processes() {
  static constexpr Process kAll[] = {{"world", make_world, false},
                                     {"lidar_driver", make_lidar_driver},
                                     {"camera_driver", make_camera_driver},
                                     {"imu_driver", make_imu_driver},
                                     {"base_driver", make_base_driver},
                                     {"map_server", make_map_server},
                                     {"amcl", make_amcl},
                                     {"planner_server", make_planner_server},
                                     {"controller_server", make_controller_server},
                                     {"behavior_server", make_behavior_server},
                                     {"velocity_smoother", make_velocity_smoother},
                                     {"bt_navigator", make_bt_navigator},
                                     {"twist_mux", make_twist_mux},
                                     {"e_stop", make_e_stop},
                                     {"lifecycle_manager_localization", nullptr},
                                     {"lifecycle_manager_navigation", nullptr},
                                     {"mission", make_mission, false}};
  return kAll;
}

}  // namespace culprit::rover
