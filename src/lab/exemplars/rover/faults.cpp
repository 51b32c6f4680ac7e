#include "exemplars/rover/faults.h"

#include <algorithm>
#include <sstream>

namespace culprit::rover {
namespace {

// A node's component has the node's name, without "_driver".
std::string component_of(const std::string& process) {
  const std::size_t end = process.find("_driver");
  return process.substr(0, end);
}

Fault shown(const std::string& process, const std::string& fault, std::string remedies) {
  const std::string component = component_of(process);
  return {component + ":" + fault, Way::kParameter, process, "fault", Value(fault), component,
          std::move(remedies)};
}

// A fault of a process, such as "kill:amcl".
Fault done_to(const char* process, Way way, const char* prefix, std::string remedies) {
  const std::string component = component_of(process);
  return {prefix + component, way, process, "", {}, component, std::move(remedies)};
}

std::vector<Fault> make_faults() {
  std::vector<Fault> all;
  for (const char* process :
       {"lidar_driver", "perception_container", "imu_driver", "base_driver", "map_server", "amcl",
        "planner_server", "controller_server", "behavior_server", "velocity_smoother",
        "bt_navigator", "twist_mux", "e_stop", "lifecycle_manager_navigation"})
    all.push_back(done_to(process, Way::kKill, "kill:", "redeploy"));
  for (const char* process : {"lidar_driver", "base_driver", "amcl", "planner_server",
                              "controller_server", "bt_navigator", "twist_mux"})
    all.push_back(done_to(process, Way::kStop, "stop:", "redeploy"));
  for (const char* process : {"amcl", "controller_server", "velocity_smoother", "bt_navigator"})
    all.push_back(done_to(process, Way::kDeactivate, "deactivate:", "start_group, activate"));
  for (const char* process : {"lidar_driver", "base_driver"})
    all.push_back(done_to(process, Way::kStray, "stray:", "end one of the two"));
  all.push_back({"stray:ekf", Way::kStray, "ekf", "", {}, "", ""});
  for (const char* fault : {"stall", "zeros", "nan", "frozen", "slow", "wrong_frame", "hang"})
    all.push_back(shown("lidar_driver", fault, "redeploy"));
  for (const char* fault : {"stall", "dark", "dim", "leak"})
    all.push_back(shown("camera_driver", fault, "redeploy"));
  all.push_back(shown("cloud_maker", "stall", "redeploy"));
  for (const char* fault : {"stall", "bias"}) all.push_back(shown("imu_driver", fault, "redeploy"));
  for (const char* fault : {"odom_frozen", "tf_stopped", "tf_late", "clock_jump", "crash", "slip"})
    all.push_back(shown("base_driver", fault, "redeploy"));
  for (const char* fault : {"stall", "tf_stopped"})
    all.push_back(shown("amcl", fault, "restart, redeploy"));
  all.push_back(shown("planner_server", "hang", "redeploy"));
  all.push_back(shown("planner_server", "costmap_frozen", "restart, redeploy"));
  all.push_back(shown("controller_server", "costmap_frozen", "restart, redeploy"));
  all.push_back(shown("controller_server", "oscillate", "redeploy"));
  all.push_back(shown("bt_navigator", "hang", "redeploy"));
  all.push_back(shown("velocity_smoother", "best_effort", "redeploy"));
  all.push_back({"controller_server:setting_lost", Way::kNextStart, "controller_server",
                 "max_speed", Value(0.1), "controller_server", "redeploy, then set_parameter"});
  all.push_back({"imu:busy", Way::kNextStart, "imu_driver", "busy_s", Value(8.0), "imu",
                 "redeploy, again and again"});
  all.push_back({"perception_container:slow_start", Way::kNextStart, "perception_container",
                 "start_s", Value(8.0), "perception_container", "redeploy"});
  all.push_back({"controller_server:slow_setting", Way::kParameter, "controller_server",
                 "max_speed", Value(0.05), "controller_server", "set_parameter, redeploy"});
  all.push_back({"kidnapped", Way::kParameter, "world", "kidnap", Value("10 5.9 1"), "amcl",
                 "call /reinitialize_global_localization"});
  all.push_back(
      {"lidar:unplugged", Way::kParameter, "world", "lidar_plugged", Value(false), "lidar", ""});
  all.push_back({"lidar:flaps", Way::kParameter, "world", "lidar_flaps", Value(true), "lidar", ""});
  all.push_back({"battery:sag", Way::kParameter, "world", "battery", Value(0.1), "base", ""});
  return all;
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> kAll = make_faults();
  return kAll;
}

void Measurements::complain(const std::string& inactive) {
  constexpr double kStandsAfter = 6;  // seconds
  complaint = !inactive.empty()           ? inactive + " is not active"
              : pose_error_m > kLostAt    ? "the rover does not know where it is"
              : standing_s > kStandsAfter ? "the rover stands"
                                          : "";
}

std::vector<std::string> Play::fault_names() const {
  std::vector<std::string> names;
  for (const Fault* fault : faults) names.push_back(fault->name);
  return names;
}

bool Play::is_fixable() const { return std::ranges::all_of(faults, &Fault::is_fixable); }

bool Play::is_cause(std::string_view component) const {
  return std::ranges::find(faults, component, &Fault::cause) != faults.end();
}

Play play_of(std::vector<const Fault*> faults, std::uint64_t seed) {
  Play play{"", std::move(faults), seed};
  for (const Fault* fault : play.faults) play.name += (play.name.empty() ? "" : "+") + fault->name;
  return play;
}

Expected<Play> find_play(std::string_view name, std::uint64_t seed) {
  std::vector<const Fault*> play;
  std::istringstream text{std::string(name)};
  for (std::string each; std::getline(text, each, '+');) {
    const auto found = std::ranges::find(faults(), each, &Fault::name);
    if (found == faults().end()) {
      std::string all;
      for (const Fault& known : faults()) all += " " + known.name;
      return Error{"the rover has no fault '" + each + "'; there are:" + all};
    }
    play.push_back(&*found);
  }
  return play_of(std::move(play), seed);
}

}  // namespace culprit::rover
