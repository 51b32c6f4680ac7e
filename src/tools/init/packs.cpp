#include "init/packs.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/units.h"
#include "base/value_list.h"
#include "init/measures.h"
#include "init/package_of.h"
#include "init/silence.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;

constexpr const char* kImage = "sensor_msgs/msg/Image";
constexpr const char* kScan = "sensor_msgs/msg/LaserScan";
constexpr const char* kCloud = "sensor_msgs/msg/PointCloud2";
constexpr const char* kJointStates = "sensor_msgs/msg/JointState";
constexpr const char* kTransforms = "tf2_msgs/msg/TFMessage";
constexpr const char* kEmptyCall = "std_srvs/srv/Empty";

// A driver of a sensor: USE <use>(name, topic, hz).
struct SensorPack {
  std::string_view package;  // of its program
  std::string_view pack;
  std::string_view use;
  std::vector<const char*> types;  // of what it publishes; the first that it has
  Duration patience;               // of the pack: how long its topic may be silent
};

const std::vector<SensorPack>& sensor_packs() {
  static const std::vector<SensorPack> kAll = {
      {"sick_scan_xd", "lidars", "sick_scan_xd", {kScan, kCloud}, 130s},
      {"urg_node2", "lidars", "urg_node2", {kScan}, 10s},
      {"realsense2_camera", "cameras", "realsense", {kImage}, 15s},
      {"usb_cam", "cameras", "usb_cam", {kImage}, 5s},
      {"depthai_ros_driver", "cameras", "depthai", {kImage}, 10s}};
  return kAll;
}

class PackChoice {
 public:
  PackChoice(const RobotProfile& seen, const std::map<std::string, std::string>& components,
             std::vector<std::string>& left_out)
      : seen_(seen), components_(components), left_out_(left_out) {}

  std::vector<PackUse> made() {
    for (const SensorPack& each : sensor_packs()) sensors(each);
    ousters();
    velodyne();
    nav2();
    ros2_control();
    slam();
    filters();
    transforms();
    move_groups();
    micro_ros();
    mavros();
    for (const std::string& node : of_package("foxglove_bridge"))
      use("foxglove", fmt::format("foxglove_bridge({})", name(node)), {node});
    return std::move(uses_);
  }

 private:
  // ---- what was seen

  std::string name(const std::string& node) const { return components_.at(node); }

  std::vector<std::string> of_package(std::string_view package) const {
    std::vector<std::string> nodes;
    for (const auto& each : components_) {
      if (package_of_node(each.first) == package) nodes.push_back(each.first);
    }
    return nodes;
  }

  std::string package_of_node(const std::string& node) const {
    if (const auto recipe = seen_.dump.recipes.find(node); recipe != seen_.dump.recipes.end())
      return recipe->second.package;
    const auto start = seen_.starts.find(node);
    return start == seen_.starts.end() ? "" : package_of(start->second.command);
  }

  std::string state_of(const std::string& node) const {
    const auto found = seen_.robot.nodes.find(node);
    return found == seen_.robot.nodes.end() ? "" : found->second.lifecycle;
  }

  bool offers(const std::string& service, const std::string& type) const {
    const auto found = seen_.robot.services.find(service);
    return found != seen_.robot.services.end() && found->second == type;
  }

  // The topics that `node` alone publishes.
  std::vector<std::string> topics_of(const std::string& node, const std::string& type) const {
    std::vector<std::string> topics;
    for (const auto& each : seen_.robot.topics) {
      if (each.second.type == type && is_valid_topic_name(each.first) &&
          each.second.publishers.contains(node) && each.second.publishers.size() == 1)
        topics.push_back(each.first);
    }
    return topics;
  }

  // The only published topic of that type; empty: there is none, or several.
  std::string only_topic(const std::string& type) const {
    std::string only;
    for (const auto& each : seen_.robot.topics) {
      if (each.second.type != type || !each.second.is_published() ||
          !is_valid_topic_name(each.first))
        continue;
      if (!only.empty()) return "";
      only = each.first;
    }
    return only;
  }

  // It goes on in a rhythm that a rule of this patience does not take for silence.
  bool is_steady(const std::string& topic, Duration patience) const {
    const auto silence = silence_of(seen_, topic);
    return silence && *silence <= patience;
  }

  // Among the topics that a node alone publishes: the first of these types that is steady. Empty:
  // none is.
  std::string steady_topic_of(const std::string& node, const std::vector<const char*>& types,
                              Duration patience) const {
    for (const char* type : types) {
      for (const std::string& topic : topics_of(node, type)) {
        if (is_steady(topic, patience)) return topic;
      }
    }
    return "";
  }

  std::string hz(const std::string& topic) const { return as_number(rate_of(seen_, topic)); }

  std::string came(const std::string& topic) const {
    return fmt::format("{} came {} times a second", topic, hz(topic));
  }

  // ---- what is chosen

  PackUse& use(std::string pack, std::string call, std::set<std::string> nodes,
               std::string evidence = "") {
    std::string known;
    for (const std::string& node : nodes)
      known += (known.empty() ? "" : ", ") +
               fmt::format("{} is of the package {}", name(node), package_of_node(node));
    if (!known.empty() && !evidence.empty()) known += "; ";
    return uses_.emplace_back(PackUse{.pack = std::move(pack),
                                      .call = std::move(call),
                                      .evidence = known + evidence,
                                      .nodes = std::move(nodes)});
  }

  void propose(std::string pack, std::string call, std::string evidence) {
    use(std::move(pack), std::move(call), {}, std::move(evidence)).is_proposal = true;
  }

  void no_pack(const std::string& node, const std::string& why) {
    left_out_.push_back(
        fmt::format("{}: no pack for {}, since {}", node, package_of_node(node), why));
  }

  // ---- drivers

  void sensors(const SensorPack& sensor) {
    for (const std::string& node : of_package(sensor.package)) {
      const std::string topic = steady_topic_of(node, sensor.types, sensor.patience);
      if (topic.empty()) {
        no_pack(node, fmt::format("no {} of it came in a rhythm", fmt::join(sensor.types, " or ")));
        continue;
      }
      use(std::string(sensor.pack),
          fmt::format("{}({}, {}, {})", sensor.use, name(node), topic, hz(topic)), {node},
          came(topic))
          .has_launcher = sensor.package == "urg_node2";
      const std::string reset = node + "/hw_reset";
      if (sensor.use == "realsense" && offers(reset, kEmptyCall))
        propose("cameras", fmt::format("realsense_hw_reset({}, {})", name(node), topic),
                "it offers " + reset);
    }
  }

  void ousters() {
    for (const std::string& node : of_package("ouster_ros")) {
      const std::string topic = steady_topic_of(node, {kCloud}, 10s);
      const std::string reset = namespace_of(node) + "/reset";
      if (topic.empty() || !offers(reset, kEmptyCall)) {
        no_pack(node, "no point clouds of it came in a rhythm, or it offers no " + reset);
        continue;
      }
      use("lidars", fmt::format("ouster({}, {}, {}, {})", name(node), topic, hz(topic), reset),
          {node}, came(topic))
          .has_launcher = true;
    }
  }

  // Which cloud is of which driver is not known where there are several.
  void velodyne() {
    const auto drivers = of_package("velodyne_driver");
    const auto clouds = of_package("velodyne_pointcloud");
    if (drivers.size() != 1 || clouds.size() != 1) {
      for (const std::string& node : drivers)
        no_pack(node, "it takes one driver and one node of velodyne_pointcloud, and no more");
      return;
    }
    const std::string packets =
        steady_topic_of(drivers[0], {"velodyne_msgs/msg/VelodyneScan"}, 10s);
    const std::string points = steady_topic_of(clouds[0], {kCloud}, 2s);
    if (packets.empty() || points.empty())
      return no_pack(drivers[0], "no packets or no point clouds came in a rhythm");
    use("lidars",
        fmt::format("velodyne({}, {}, {}, {}, {})", name(drivers[0]), name(clouds[0]), packets,
                    points, hz(packets)),
        {drivers[0], clouds[0]}, came(packets));
  }

  // For an agent whose board has one node: several in a process are not declared.
  void micro_ros() {
    for (const std::string& node : of_package("micro_ros_agent")) {
      std::string topic;
      for (const auto& each : seen_.robot.topics) {
        if (each.second.publishers == std::set{node} && is_valid_topic_name(each.first) &&
            is_steady(each.first, 5s)) {
          topic = each.first;
          break;
        }
      }
      if (topic.empty()) {
        no_pack(node, "no topic of the board came in a rhythm");
        continue;
      }
      use("micro_ros", fmt::format("micro_ros({0}, {0}_board, {1})", name(node), topic), {node},
          came(topic));
    }
  }

  void mavros() {
    for (const std::string& node : of_package("mavros")) {
      const std::string state = steady_topic_of(node, {"mavros_msgs/msg/State"}, 15s);
      if (state.empty()) {
        no_pack(node, "no state of the vehicle came from it in a rhythm");
        continue;
      }
      use("mavros", fmt::format("mavros({}, {})", name(node), state), {node}, came(state));
    }
  }

  // ---- navigation

  void nav2() {
    constexpr std::string_view kNavigation = "/lifecycle_manager_navigation";
    constexpr std::string_view kLocalization = "/lifecycle_manager_localization";
    for (const auto& each : seen_.robot.nodes) {
      const std::string& node = each.first;
      if (!offers(node + "/manage_nodes", "nav2_msgs/srv/ManageLifecycleNodes")) continue;
      const std::string space = namespace_of(node);
      const std::string in = space.empty() ? "" : " IN " + space;
      const std::string evidence = node + " offers manage_nodes, and its servers are active";
      const bool has_group = use_group(node, space);
      if (node == space + std::string(kNavigation) &&
          are_active(space, {"controller_server", "planner_server", "bt_navigator"})) {
        if (!has_group) use("nav2", "nav2_navigation" + in, {}, evidence);
        costmap(space, in, "local", "controller_server");
        costmap(space, in, "global", "planner_server");
      }
      if (node == space + std::string(kLocalization) && are_active(space, {"map_server", "amcl"})) {
        if (!has_group) use("nav2", "nav2_localization" + in, {}, evidence);
        amcl(space, in);
      }
      servers(space);
    }
  }

  // Uses the pack for the group that the manager names in its parameter, if all members are declared and active.
  bool use_group(const std::string& manager, const std::string& space) {
    const auto& told = seen_.robot.nodes.at(manager).parameters;
    if (!told || !components_.contains(manager)) return false;
    const auto names = told->find("node_names");
    const auto* text =
        names != told->end() && names->second ? std::get_if<std::string>(&*names->second) : nullptr;
    const auto list = text != nullptr ? list_from_text(*text) : std::nullopt;
    if (!list || list->empty()) return false;
    std::string members;
    for (const Value& each : *list) {
      const auto* own = std::get_if<std::string>(&each);
      const std::string node = own == nullptr          ? ""
                               : own->starts_with('/') ? *own
                                                       : space + "/" + *own;
      if (!components_.contains(node) || state_of(node) != "active") return false;
      members += (members.empty() ? "" : ", ") + name(node);
    }
    constexpr std::string_view kPrefix = "lifecycle_manager_";
    std::string group = name(manager);
    const auto prefix = group.find(kPrefix);
    if (prefix == std::string::npos || prefix + kPrefix.size() == group.size()) {
      group += "_group";
    } else {
      group.erase(prefix, kPrefix.size());
    }
    if (is_taken(group)) group += "_group";
    std::string title = group;
    title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
    use("nav2", fmt::format("nav2_group({}, {}, {})", group, name(manager), title), {},
        manager + " names these servers in its node_names, and all are active")
        .group = fmt::format("GROUP {} {{ {} }} MANAGER {}\n", group, members, name(manager));
    return true;
  }

  bool is_taken(const std::string& word) const {
    return std::ranges::any_of(components_, [&](const auto& each) { return each.second == word; });
  }

  bool are_active(const std::string& space, std::initializer_list<const char*> nodes) const {
    return std::ranges::all_of(
        nodes, [&](const char* node) { return state_of(space + "/" + node) == "active"; });
  }

  // Each that is declared, once; a namespace has several lifecycle managers.
  void servers(const std::string& space) {
    for (const auto& each : components_) {
      const std::string& node = each.first;
      if (namespace_of(node) != space || !package_of_node(node).starts_with("nav2_") ||
          state_of(node) != "active" || !servers_.insert(node).second)
        continue;
      use("nav2", fmt::format("nav2_server({})", name(node)), {node}).has_launcher = true;
    }
  }

  void costmap(const std::string& space, const std::string& in, const std::string& which,
               const std::string& server) {
    const std::string topic = space + "/" + which + "_costmap/costmap";
    if (is_steady(topic, 10s))
      propose("nav2", fmt::format("nav2_costmap({}, {}){}", which, server, in), came(topic));
  }

  void amcl(const std::string& space, const std::string& in) {
    const std::string scan = only_topic(kScan);
    // IN puts the namespace in front of arguments, too.
    if (scan.starts_with(space + "/") && is_steady(scan, 1s) &&
        offers(space + "/request_nomotion_update", kEmptyCall))
      propose("nav2",
              fmt::format("nav2_amcl(0.5, /amcl_pose, {}){}", scan.substr(space.size()), in),
              space + "/amcl is active, and " + came(scan));
  }

  void slam() {
    for (const std::string& node : of_package("slam_toolbox")) {
      const std::string scan = only_topic(kScan);
      const auto maps = topics_of(node, "nav_msgs/msg/OccupancyGrid");
      if (scan.empty() || maps.empty()) {
        no_pack(node, "it publishes no map, or there is not just one topic of scans");
        continue;
      }
      use("slam_toolbox", fmt::format("slam_toolbox({}, {}, {})", name(node), scan, maps[0]),
          {node}, "it publishes " + maps[0])
          .has_launcher = true;
    }
  }

  void filters() {
    const auto nodes = of_package("robot_localization");
    for (const std::string& node : nodes) {
      const std::string space = namespace_of(node);
      const auto in_one_namespace = std::ranges::count_if(
          nodes, [&](const std::string& other) { return namespace_of(other) == space; });
      const std::string odometry = steady_topic_of(node, {"nav_msgs/msg/Odometry"}, 3s);
      const std::string reset = space + "/reset";
      if (odometry.empty()) {
        no_pack(node, "no odometry of it came in a rhythm");
      } else if (in_one_namespace > 1 || !offers(reset, kEmptyCall)) {
        no_pack(node, "it is not one filter that offers " + reset);
      } else {
        use("robot_localization",
            fmt::format("robot_localization({}, {}, {})", name(node), odometry, reset), {node},
            came(odometry));
      }
    }
  }

  // ---- what else there is

  void transforms() {
    const std::string topic = "/tf";
    const auto tf = seen_.robot.topics.find(topic);
    if (tf == seen_.robot.topics.end() || tf->second.type != kTransforms || !is_steady(topic, 2s))
      return;
    use("tf", "tf", {}, came(topic));
    const std::string joint_states = only_topic(kJointStates);
    for (const std::string& node : of_package("robot_state_publisher")) {
      if (!tf->second.publishers.contains(node) || !is_steady(joint_states, 500ms)) {
        no_pack(node, "it does not publish /tf, or there is not just one topic of joint states");
        continue;
      }
      use("tf", fmt::format("robot_state_publisher({}, {})", name(node), joint_states), {node},
          came(joint_states));
    }
  }

  void move_groups() {
    for (const std::string& node : of_package("moveit_ros_move_group")) {
      const std::string joint_states = only_topic(kJointStates);
      if (!is_steady(joint_states, 1s)) {
        no_pack(node, "there is not just one topic of joint states in a rhythm");
        continue;
      }
      use("moveit", fmt::format("move_group({}, {})", name(node), joint_states), {node},
          came(joint_states));
    }
  }

  // By what a controller manager says of itself, since Jazzy.
  void ros2_control() {
    for (const LiveInventory::Status& hardware : seen_.robot.diagnostics) {
      constexpr std::string_view kTask = ": Hardware Components Activity";
      if (!hardware.name.ends_with(kTask)) continue;
      const std::string manager = hardware.name.substr(0, hardware.name.size() - kTask.size());
      if (!is_valid_node_name(manager) || !seen_.robot.nodes.contains("/" + manager)) continue;
      const std::string other = manager == "controller_manager" ? "" : ", " + manager;
      const auto parts = active_in(hardware);
      for (const std::string& part : parts)
        use("ros2_control", fmt::format("ros2_control_hardware({}{})", part, other), {},
            fmt::format("/{} says that it is active", manager));
      const auto controllers =
          std::ranges::find(seen_.robot.diagnostics, manager + ": Controllers Activity",
                            &LiveInventory::Status::name);
      if (controllers == seen_.robot.diagnostics.end()) continue;
      for (const std::string& each : active_in(*controllers))
        controller(each, parts, other, manager);
    }
  }

  void controller(const std::string& controller, const std::vector<std::string>& hardware,
                  const std::string& manager_argument, const std::string& manager) {
    if (hardware.size() != 1)
      return left_out_.push_back(
          controller + ": no pack for it, since it is not known which hardware it commands");
    const bool commands_nothing = controller.ends_with("broadcaster");
    use("ros2_control",
        fmt::format("ros2_control_{}({}, {}{})", commands_nothing ? "broadcaster" : "controller",
                    controller, hardware[0], manager_argument),
        {}, fmt::format("/{} says that it is active", manager));
  }

  // Names that "<name>.state" says of to be active.
  static std::vector<std::string> active_in(const LiveInventory::Status& status) {
    constexpr std::string_view kState = ".state";
    std::vector<std::string> names;
    for (const auto& each : status.values) {
      if (!each.first.ends_with(kState) || each.second != "active") continue;
      const std::string name = each.first.substr(0, each.first.size() - kState.size());
      if (is_valid_node_name(name)) names.push_back(name);
    }
    return names;
  }

  const RobotProfile& seen_;
  const std::map<std::string, std::string>& components_;
  std::vector<std::string>& left_out_;
  std::set<std::string> servers_;
  std::vector<PackUse> uses_;
};

}  // namespace

std::string include_of(const std::string& pack) { return "INCLUDE \"packs/" + pack + ".rules\""; }

std::vector<PackUse> packs_for(const RobotProfile& seen,
                               const std::map<std::string, std::string>& components,
                               std::vector<std::string>& left_out) {
  return PackChoice(seen, components, left_out).made();
}

}  // namespace culprit::init
