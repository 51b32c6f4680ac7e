// The packs are read as they are in rules/, so each choice is checked with what it stands for.
#include "init/packs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "init/draft.h"
#include "init/package_of.h"
#include "language/checker.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Robot {
  RobotProfile seen;

  Robot() { seen.looked = 30s; }

  Robot& node(const std::string& name, const std::string& package, const std::string& state = "") {
    seen.robot.nodes[name] = {.parameters = {}, .lifecycle = state, .pid = next_pid_++};
    seen.starts[name].command = {"/opt/ros/jazzy/lib/" + package + "/program", name};
    return *this;
  }
  // Of 10 Hz.
  Robot& topic(const std::string& name, const std::string& type, const std::string& node) {
    seen.robot.topics[name].type = type;
    seen.robot.topics[name].publishers.insert(node);
    seen.rhythms[name] = {301, 30s, 110ms};
    return *this;
  }
  Robot& service(const std::string& name, const std::string& type) {
    seen.robot.services[name] = type;
    return *this;
  }
  Robot& status(const std::string& name, std::map<std::string, std::string> values) {
    seen.robot.diagnostics.push_back({name, "", 0, std::move(values)});
    seen.statuses[{name, ""}] = {30, 0, {}};
    return *this;
  }

  // The draft, which has to be right with all that it includes.
  std::string draft() const {
    const std::string text = init::draft(seen, Packs::kChosen);
    const auto load = [](const std::string& file, const std::string&) {
      return Source::read((file.find('/') == std::string::npos ? "rules/packs/" : "rules/") + file);
    };
    const Expansion rules = expand({"draft", text}, load);
    EXPECT_THAT(rules.mistakes, testing::IsEmpty()) << text;
    const Checked checked = check(rules, Strictness::kStrict);
    for (const Diagnostic& each : checked.diagnostics)
      ADD_FAILURE() << render(each, rules.source) << text;
    return text;
  }

 private:
  int next_pid_ = 100;
};

const char* const kScan = "sensor_msgs/msg/LaserScan";
const char* const kImage = "sensor_msgs/msg/Image";
const char* const kCloud = "sensor_msgs/msg/PointCloud2";
const char* const kEmpty = "std_srvs/srv/Empty";

Robot navigating(const std::string& space) {
  Robot robot;
  for (const char* which : {"navigation", "localization"}) {
    const std::string manager = space + "/lifecycle_manager_" + which;
    robot.node(manager, "nav2_lifecycle_manager")
        .service(manager + "/manage_nodes", "nav2_msgs/srv/ManageLifecycleNodes");
  }
  for (const char* name :
       {"controller_server", "planner_server", "bt_navigator", "map_server", "amcl"})
    robot.node(space + "/" + name, "nav2_" + std::string(name), "active");
  return robot;
}

TEST(Packs, AreChosenByThePackageOfTheProgramAndWhatItPublishes) {
  Robot robot;
  robot.node("/front", "sick_scan_xd").topic("/front/scan", kScan, "/front");
  robot.node("/back", "urg_node2", "active").topic("/back/scan", kScan, "/back");
  robot.node("/os", "ouster_ros", "active")
      .topic("/points", kCloud, "/os")
      .service("/reset", kEmpty);
  robot.node("/velo", "velodyne_driver")
      .topic("/packets", "velodyne_msgs/msg/VelodyneScan", "/velo")
      .node("/cloud", "velodyne_pointcloud")
      .topic("/velo_points", kCloud, "/cloud");
  robot.node("/cam/rs", "realsense2_camera")
      .topic("/cam/color", kImage, "/cam/rs")
      .service("/cam/rs/hw_reset", kEmpty);
  robot.node("/usb", "usb_cam").topic("/usb/image", kImage, "/usb");
  robot.node("/oak", "depthai_ros_driver").topic("/oak/rgb", kImage, "/oak");
  const std::string text = robot.draft();
  for (const char* line :
       {"INCLUDE \"packs/cameras.rules\"\nINCLUDE \"packs/lidars.rules\"\n",
        "# guess: front is of the package sick_scan_xd; /front/scan came 10 times a second.\n"
        "USE sick_scan_xd(front, /front/scan, 10)\n",
        "USE urg_node2(back, /back/scan, 10)\n", "USE ouster(os, /points, 10, /reset)\n",
        "USE velodyne(velo, cloud, /packets, /velo_points, 10)\n",
        "USE realsense(rs, /cam/color, 10)\n", "USE usb_cam(usb, /usb/image, 10)\n",
        "USE depthai(oak, /oak/rgb, 10)\n", "#   USE realsense_hw_reset(rs, /cam/color)\n",
        "NODE /back LAUNCH \"/opt/ros/jazzy/lib/urg_node2/program /back\" LIFECYCLE launcher\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_THAT(text, Not(HasSubstr("_failed"))) << "the packs see what rules of its own would";
}

TEST(Packs, OfNavigationAreChosenWhereAllOfItIsActive) {
  const std::string text = navigating("").draft();
  EXPECT_THAT(text, AllOf(HasSubstr("USE nav2_navigation\n"), HasSubstr("USE nav2_localization\n"),
                          HasSubstr("USE nav2_server(controller_server)\n"),
                          HasSubstr("RULE lifecycle_manager_navigation_failed\n")));
  Robot half_up = navigating("");
  half_up.seen.robot.nodes["/bt_navigator"].lifecycle = "inactive";
  EXPECT_THAT(half_up.draft(), AllOf(Not(HasSubstr("USE nav2_navigation")),
                                     Not(HasSubstr("USE nav2_server(bt_navigator)"))));
}

TEST(Packs, OfAManagerThatNamesItsServersAreForTheGroupOfThese) {
  Robot robot = navigating("");
  robot.node("/collision_monitor", "nav2_collision_monitor", "active");
  robot.seen.robot.nodes["/lifecycle_manager_navigation"].parameters = {
      {"node_names",
       Value(R"(["controller_server", "planner_server", "bt_navigator", "collision_monitor"])")}};
  const std::string text = robot.draft();
  EXPECT_THAT(
      text,
      AllOf(HasSubstr("GROUP navigation { controller_server, planner_server, bt_navigator, "
                      "collision_monitor } MANAGER lifecycle_manager_navigation\n"
                      "USE nav2_group(navigation, lifecycle_manager_navigation, Navigation)\n"),
            Not(HasSubstr("USE nav2_navigation")), HasSubstr("USE nav2_localization\n")));
  // One of them is not up.
  robot.seen.robot.nodes["/collision_monitor"].lifecycle = "inactive";
  EXPECT_THAT(robot.draft(), Not(HasSubstr("GROUP navigation")));
}

TEST(Packs, OfNavigationInANamespaceAreUsedInIt) {
  Robot robot = navigating("/r1");
  robot.node("/r1/lidar", "my_lidar").topic("/r1/scan", kScan, "/r1/lidar");
  robot.service("/r1/request_nomotion_update", kEmpty);
  const std::string text = robot.draft();
  EXPECT_THAT(text, AllOf(HasSubstr("USE nav2_navigation IN /r1\n"),
                          HasSubstr("USE nav2_server(planner_server)\n"),
                          HasSubstr("#   USE nav2_amcl(0.5, /amcl_pose, /scan) IN /r1\n")));
}

TEST(Packs, OfHardwareAreChosenByWhatItsManagerSays) {
  Robot robot;
  robot.node("/controller_manager", "controller_manager")
      .status("controller_manager: Hardware Components Activity", {{"arm.state", "active"}})
      .status("controller_manager: Controllers Activity",
              {{"joint_state_broadcaster.state", "active"},
               {"arm_controller.state", "active"},
               {"spare_controller.state", "inactive"}});
  const std::string text = robot.draft();
  EXPECT_THAT(text, AllOf(HasSubstr("USE ros2_control_hardware(arm)\n"),
                          HasSubstr("USE ros2_control_broadcaster(joint_state_broadcaster, arm)\n"),
                          HasSubstr("USE ros2_control_controller(arm_controller, arm)\n"),
                          Not(HasSubstr("spare_controller,"))));
}

TEST(Packs, OfOtherSoftwareAreChosenWithTheTopicsThatItHas) {
  Robot robot;
  robot.node("/lidar", "my_lidar").topic("/scan_1", kScan, "/lidar");
  robot.node("/slam", "slam_toolbox").topic("/map", "nav_msgs/msg/OccupancyGrid", "/slam");
  robot.node("/ekf", "robot_localization")
      .topic("/odom", "nav_msgs/msg/Odometry", "/ekf")
      .service("/reset", kEmpty);
  robot.node("/joints", "my_joints").topic("/js", "sensor_msgs/msg/JointState", "/joints");
  robot.node("/rsp", "robot_state_publisher").topic("/tf", "tf2_msgs/msg/TFMessage", "/rsp");
  robot.topic("/tf", "tf2_msgs/msg/TFMessage", "/ekf");
  robot.node("/move_group", "moveit_ros_move_group");
  robot.node("/fox", "foxglove_bridge");
  robot.node("/fcu", "mavros").topic("/mavros/state", "mavros_msgs/msg/State", "/fcu");
  robot.node("/board", "micro_ros_agent").topic("/imu", "sensor_msgs/msg/Imu", "/board");
  const std::string text = robot.draft();
  for (const char* line :
       {"USE slam_toolbox(slam, /scan_1, /map)\n", "USE robot_localization(ekf, /odom, /reset)\n",
        "USE tf\n", "USE move_group(move_group, /js)\n", "USE foxglove_bridge(fox)\n",
        "USE mavros(fcu, /mavros/state)\n", "USE micro_ros(board, board_board, /imu)\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(Packs, NothingIsChosenForWhatTheRobotHasNot) {
  // The name alone, or the package alone.
  Robot robot;
  robot.node("/sick_scan_xd", "my_driver").topic("/scan", kScan, "/sick_scan_xd");
  robot.node("/mute", "sick_scan_xd");
  robot.node("/os", "ouster_ros").topic("/points", kCloud, "/os");
  robot.node("/ekf", "robot_localization").topic("/odom", "nav_msgs/msg/Odometry", "/ekf");
  robot.node("/controller_server", "nav2_controller", "active");
  robot.status("controller_manager: Hardware Components Activity", {{"arm.state", "active"}});
  const std::string text = robot.draft();
  EXPECT_THAT(text, AllOf(Not(HasSubstr("INCLUDE")), Not(HasSubstr("USE "))));
  EXPECT_THAT(
      text, HasSubstr("# /mute: no pack for sick_scan_xd, since no sensor_msgs/msg/LaserScan or "));
  EXPECT_THAT(text, HasSubstr("# /os: no pack for ouster_ros, since "));
  for (const char* rule : {"RULE mute_failed\n", "RULE os_failed\n", "RULE ekf_failed\n"})
    EXPECT_THAT(text, HasSubstr(rule)) << "what has no pack has a rule, as ever";
}

TEST(Packs, ACameraThatIsSlowerThanItsPackIsPatientGetsNone) {
  Robot robot;
  robot.node("/usb", "usb_cam").topic("/image", kImage, "/usb");
  robot.seen.rhythms["/image"] = {15, 28s, 2100ms};
  EXPECT_THAT(robot.draft(), Not(HasSubstr("USE usb_cam")));
}

TEST(Packs, AreNotChosenUnlessAskedFor) {
  Robot robot;
  robot.node("/usb", "usb_cam").topic("/image", kImage, "/usb");
  EXPECT_THAT(draft(robot.seen), Not(HasSubstr("USE ")));
}

TEST(PackageOf, APythonNodesScript) {
  EXPECT_EQ(package_of({"/usr/bin/python3", "/opt/ros/jazzy/lib/my_arm/arm", "--x"}), "my_arm");
  EXPECT_EQ(package_of({"/usr/bin/python3", "lib/my_arm/arm"}), "");
  EXPECT_EQ(package_of({"/usr/bin/thing"}), "");
}

}  // namespace
}  // namespace culprit::init
