#include "language/test_example_robot.h"

namespace culprit {

const LiveInventory& example_robot() {
  static const LiveInventory kRobot = [] {
    LiveInventory robot;
    LiveInventory::Node& camera = robot.nodes["/robot/camera"];
    camera.parameters = {{"exposure", Value(0.5)}};
    camera.lifecycle = "active";
    robot.nodes["/left/wheel"].pid = 41;
    robot.nodes["/right/wheel"];
    robot.nodes["/left/arm"];
    robot.nodes["/right/arm"];
    robot.topics["/robot/image"] = {
        .type = "sensor_msgs/msg/Image",
        .publishers = {"/robot/camera"},
        .rate = {},
        .fields = {},
        .unreadable = {{"heigt",
                        "sensor_msgs/msg/Image has no field 'heigt'; its fields are header, "
                        "height, width, encoding, is_bigendian, step, data"}}};
    robot.topics["/diagnostics"] = {.type = "diagnostic_msgs/msg/DiagnosticArray",
                                    .publishers = {"/robot/camera"},
                                    .rate = {},
                                    .fields = {},
                                    .unreadable = {}};
    robot.services = {{"/robot/camera/change_state", "lifecycle_msgs/srv/ChangeState"},
                      {"/robot/camera/get_state", "lifecycle_msgs/srv/GetState"},
                      {"/robot/camera/set_parameters", "rcl_interfaces/srv/SetParameters"},
                      {"/robot/camera/recalibrate", "std_srvs/srv/Trigger"},
                      {"/robot/camera/light", "std_srvs/srv/SetBool"}};
    robot.request_troubles = {
        {"/robot/camera/light", "on: true",
         "std_srvs/srv/SetBool: std_srvs/srv/SetBool_Request has no field 'on'; it has data"}};
    robot.diagnostics = {{"camera", "camera_0", 0, {{"entropy", "0.03"}}}};
    robot.unit_troubles = {
        {{"camra.service", false}, "systemd has no camra.service; did you mean camera.service?"}};
    robot.host_troubles = {
        {"robot@rovr2",
         "robot@rovr2: ssh: Could not resolve hostname rovr2: Name or service not known; is "
         "HOST its name? ssh robot@rovr2 should connect"}};
    robot.launch_troubles = {
        {"camera", LiveInventory::LaunchTrouble::Clause::kSetup, "/opt/ros/humbel/setup.bash",
         "SETUP: cannot find /opt/ros/humbel/setup.bash: No such file or "
         "directory"},
        {"lidar", LiveInventory::LaunchTrouble::Clause::kRunning, "scan_driver",
         "lidar runs with '--fps 30', and its LAUNCH has '--fps 15'"}};
    return robot;
  }();
  return kRobot;
}

}  // namespace culprit
