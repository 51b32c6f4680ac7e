#include "init/draft.h"

#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "language/formatter.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// A camera of 20 Hz that a person started, and a lidar of 10 Hz that systemd did.
RobotProfile robot() {
  RobotProfile seen;
  seen.looked = 30s;
  seen.domain = 7;
  seen.robot.nodes["/robot/camera"] = {.parameters = {}, .lifecycle = "active", .pid = 11};
  seen.robot.nodes["/lidar"] = {.parameters = {}, .lifecycle = "", .pid = 12};
  seen.robot.topics["/robot/image"] = {"sensor_msgs/msg/Image", {"/robot/camera"}, {}, {}, {}};
  seen.robot.topics["/scan"] = {"sensor_msgs/msg/LaserScan", {"/lidar"}, {}, {}, {}};
  seen.rhythms["/robot/image"] = {601, 30s, 70ms};
  seen.rhythms["/scan"] = {301, 30s, 130ms};
  seen.starts["/robot/camera"] = {.command = {"/opt/cam/driver", "--name", "front left"},
                                  .environment = {"ROS_DOMAIN_ID=7"},
                                  .withheld = {"API_KEY"},
                                  .folder = "/home/robot/my data",
                                  .owner = "process 9 (bash)",
                                  .declare = ""};
  seen.starts["/lidar"] = {.command = {"/opt/lidar"},
                           .environment = {},
                           .withheld = {},
                           .folder = "",
                           .owner = "systemd as lidar.service",
                           .declare = "UNIT lidar.service"};
  return seen;
}

RuleSet rules_in(const std::string& text) {
  const Checked checked = check({"draft", text}, Strictness::kStrict);
  EXPECT_THAT(checked.diagnostics, testing::IsEmpty()) << text;
  return checked.rules ? *checked.rules : RuleSet{};
}

RuleSet rules_of(const RobotProfile& seen) { return rules_in(draft(seen)); }

// With all that it proposes.
RuleSet rules_with_proposals(const RobotProfile& seen) {
  return rules_in(std::regex_replace(
      draft(seen), std::regex("\n#   (\\s*(SIGNAL|INTERLOCK|RULE|POLICIES|TRIGGER) )"), "\n$1"));
}

const Component& component(const RuleSet& rules, const std::string& name) {
  return *std::ranges::find(rules.components, name, &Component::name);
}

TEST(Draft, NoCommandLineAndNoVariableWritesRules) {
  RobotProfile seen = robot();
  seen.robot.nodes["/other"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/other"] = {.command = {"ros2", "topic\nCOMPONENT evil NODE /x LAUNCH \"evil\"\n"},
                           .environment = {},
                           .withheld = {},
                           .folder = "",
                           .owner = "",
                           .declare = ""};
  seen.starts["/robot/camera"].withheld = {"KEY\nCOMPONENT evil NODE /x LAUNCH \"evil\"\n"};
  EXPECT_THAT(draft(seen), Not(HasSubstr("\nCOMPONENT evil")));
  EXPECT_EQ(rules_of(seen).components.size(), 2u);
}

TEST(Draft, LeavesOutToolsAndSaysSo) {
  RobotProfile seen = robot();
  seen.robot.nodes["/rosbag2_recorder"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/rosbag2_recorder"].command = {"/usr/bin/python3", "/opt/ros/humble/bin/ros2", "bag",
                                              "record", "-a"};
  seen.robot.nodes["/_ros2cli_4711"] = {.parameters = {}, .lifecycle = "", .pid = 14};
  const std::string text = draft(seen);
  EXPECT_EQ(rules_of(seen).components.size(), 2u);
  EXPECT_THAT(text,
              HasSubstr("# /rosbag2_recorder: it is a tool (ros2 bag), no part of the robot"));
  EXPECT_THAT(text, HasSubstr("# /_ros2cli_4711: it is a command line tool"));
}

TEST(Draft, LeavesOutWhatComesAndGoesAndSaysSo) {
  RobotProfile seen = robot();
  seen.robot.nodes["/monitor"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/monitor"].command = {"/usr/bin/monitor"};
  seen.came_late = {"/monitor"};
  seen.left = {"/snapshot"};
  const std::string text = draft(seen);
  EXPECT_EQ(rules_of(seen).components.size(), 2u);
  EXPECT_THAT(text, HasSubstr("# /monitor: it came while culprit watched"));
  EXPECT_THAT(text, HasSubstr("# /snapshot: it left while culprit watched"));
}

TEST(Draft, StartsAsWhatWasSeenWasStarted) {
  const RuleSet rules = rules_of(robot());
  ASSERT_EQ(rules.components.size(), 2u);
  const Component& camera = component(rules, "camera");
  EXPECT_EQ(camera.node, "/robot/camera");
  EXPECT_THAT(camera.launch, testing::ElementsAre("/opt/cam/driver", "--name", "front left"));
  EXPECT_EQ(camera.folder, "/home/robot/my data");
  const Component& lidar = component(rules, "lidar");
  ASSERT_TRUE(lidar.unit);
  EXPECT_EQ(lidar.unit->name, "lidar.service");
}

TEST(Draft, SaysWhatWasGuessedAndWhy) {
  EXPECT_THAT(
      draft(robot()),
      testing::StartsWith(
          R"(# Drafted by `culprit init` from what domain 7 showed in 30s, while it was taken to be well.
# What culprit guessed is marked "guess". Read it, then try it: culprit run --dry-run FILE

CYCLE 200ms

# guess: process 9 (bash) started camera. If it restarts nodes that exit, add RESPAWNED to them.
# Variables of theirs that are not copied, for they may be secrets: API_KEY
COMPONENT lidar NODE /lidar UNIT lidar.service
COMPONENT camera NODE /robot/camera LAUNCH "/opt/cam/driver --name 'front left'" ENV "ROS_DOMAIN_ID=7" CWD "/home/robot/my data"

# guess: /scan had 10 Hz: 301 messages, at most 130ms apart.
# With 95 % certainty, less than 1 % of its gaps are longer. The timeout is 3 times the longest gap, rounded up, and at least 300ms.
RULE lidar_failed
  POLICIES ERROR
  TRIGGER !alive(lidar) || age(/scan) > 500ms
    # guess: how often it helps, in percent; culprit learns that from every attempt
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 25

# guess: /robot/image had 20 Hz: 601 messages, at most 70ms apart.
# With 95 % certainty, less than 0.5 % of its gaps are longer. The timeout is 3 times the longest gap, rounded up, and at least 300ms.
RULE camera_failed
  POLICIES ERROR
  TRIGGER !alive(camera) || age(/robot/image) > 300ms
    # guess: how often it helps, in percent; culprit learns that from every attempt
    STRATEGY camera_restart 50 10
      ADAPTATION camera restart 10
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 25

# What `culprit init` wrote itself: by these marks --update leaves alone what you change.
# marks )"));
}

TEST(Draft, NothingThatAProcessWasStartedWithIsReadAsAnythingElse) {
  RobotProfile seen = robot();
  const std::vector<std::string> odd = {"/opt/cam/driver", "it's",  "a\"b", "c\\d",
                                        "two\nlines",      "\ttab", "",     "$HOME",
                                        "# no comment"};
  seen.starts["/robot/camera"].command = odd;
  EXPECT_EQ(component(rules_of(seen), "camera").launch, odd);
}

TEST(Draft, OfTwoNodesOfOneNameEachHasItsOwn) {
  RobotProfile seen = robot();
  seen.robot.nodes["/left/camera"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/left/camera"].command = {"/opt/cam/driver", "left"};
  const RuleSet rules = rules_of(seen);
  EXPECT_EQ(component(rules, "left_camera").node, "/left/camera");
  EXPECT_EQ(component(rules, "robot_camera").node, "/robot/camera");
}

TEST(Draft, AWordOfTheLanguageIsNoName) {
  RobotProfile seen = robot();
  seen.robot.nodes["/RULE"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/RULE"].command = {"/opt/rule"};
  EXPECT_EQ(component(rules_of(seen), "RULE_node").node, "/RULE");
}

TEST(Draft, WhatCannotBeStartedAgainIsListedWithTheReason) {
  RobotProfile seen = robot();
  seen.robot.nodes["/far"] = {};
  seen.robot.nodes["/part"] = {.parameters = {}, .lifecycle = "", .pid = 12};
  seen.starts["/part"] = seen.starts["/robot/camera"];
  seen.robot.services["/lidar/_container/load_node"] = "composition_interfaces/srv/LoadNode";
  const std::string text = draft(seen);
  EXPECT_THAT(text, HasSubstr("# /far: its process is not on this machine"));
  EXPECT_THAT(text, HasSubstr("# /part: it lives in process 12 with /lidar. Write what loads it: "
                              "IN /lidar PLUGIN"));
  EXPECT_THAT(text, HasSubstr("# /lidar: it loads /part, and how is not known"));
  EXPECT_THAT(text, Not(HasSubstr("COMPONENT lidar")));
}

// As Nav2's servers have it: a costmap of their own, and clients that answer nothing.
TEST(Draft, TheNodesOfOneProcessAreOneComponent) {
  RobotProfile seen = robot();
  using Told = std::map<std::string, std::optional<Value>>;
  seen.robot.nodes["/lidar"].parameters = Told{};
  seen.robot.nodes["/map/map"] = {.parameters = Told{}, .lifecycle = "active", .pid = 12};
  seen.robot.nodes["/lidar_client"] = {.parameters = {}, .lifecycle = "", .pid = 12};
  seen.starts["/map/map"] = seen.starts["/lidar_client"] = seen.starts["/lidar"];
  seen.robot.topics["/map"].publishers = {"/map/map"};
  seen.rhythms["/map"] = {301, 30s, 130ms};
  const std::string text = draft(seen);
  EXPECT_THAT(text, HasSubstr("COMPONENT lidar NODE /lidar /map/map UNIT lidar.service\n"));
  EXPECT_THAT(text, HasSubstr("TRIGGER !alive(lidar) || age(/map) > "));
  EXPECT_THAT(text, Not(HasSubstr("lidar_client")));
  EXPECT_EQ(component(rules_of(seen), "lidar").other_nodes, std::vector<std::string>{"/map/map"});
}

TEST(Draft, WithoutARhythmThereIsNoSilence) {
  RobotProfile seen = robot();
  seen.rhythms["/robot/image"] = {9, 30s, 4s};
  seen.rhythms["/scan"] = {100, 30s, 20s};
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("age(")));
  EXPECT_THAT(text, HasSubstr("# /robot/image: 9 messages came, too few for a rhythm"));
  EXPECT_THAT(text, HasSubstr("# /scan: it has no rhythm: 100 messages"));
  EXPECT_THAT(text, HasSubstr("!alive(camera)"));
}

TEST(Draft, TheSilenceOfATopicOfSeveralNodesIsNobodys) {
  RobotProfile seen = robot();
  seen.robot.topics["/scan"].publishers.insert("/robot/camera");
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("age(/scan)")));
  EXPECT_THAT(text, HasSubstr("# /scan: several nodes publish it"));
}

TEST(Draft, OfSeveralPublishersEachInARhythmIsWatchedByItself) {
  RobotProfile seen = robot();
  seen.robot.topics["/tf"] = {"tf2_msgs/msg/TFMessage", {"/robot/camera", "/lidar"}, {}, {}, {}};
  seen.rhythms["/tf"] = {640, 30s, 60ms};
  seen.rhythms_of_publishers["/tf"] = {{"/lidar", {601, 30s, 120ms}},
                                       {"/robot/camera", {39, 30s, 9s}}};
  const std::string text = draft(seen);
  EXPECT_THAT(text,
              HasSubstr("!alive(lidar) || age(/scan) > 500ms || age(/tf FROM lidar) > 500ms"));
  EXPECT_THAT(text, HasSubstr("# guess: /tf from /lidar had 20 Hz"));
  EXPECT_THAT(text, Not(HasSubstr("FROM camera"))) << "it publishes from time to time";
  EXPECT_THAT(text, Not(HasSubstr("# /tf: several nodes publish it")));
  (void)rules_of(seen);
}

TEST(Draft, BondsAreNotWatchedForSilence) {
  RobotProfile seen = robot();
  seen.robot.topics["/bond"] = {"bond/msg/Status", {"/robot/camera", "/lidar"}, {}, {}, {}};
  seen.rhythms_of_publishers["/bond"] = {{"/lidar", {31, 30s, 1s}},
                                         {"/robot/camera", {31, 30s, 1s}}};
  EXPECT_THAT(draft(seen), Not(HasSubstr("age(/bond")));
}

TEST(Draft, ToolsAndNamesThatRosDoesNotTakeAreNoComponents) {
  RobotProfile seen = robot();
  for (const char* name : {"/rviz2", "/_ros2cli_4711", "/launch_ros_12", "/bad name\nRULE x"}) {
    seen.robot.nodes[name] = {.parameters = {}, .lifecycle = "", .pid = 20};
    seen.starts[name] = seen.starts["/robot/camera"];
  }
  const link::ValueCourse varied{
      .numbers = 20, .others = 0, .least = 1, .most = 2, .last = 1, .rose = true, .fell = true};
  seen.statuses[{"evil\nRULE y", ""}] = {20, 0, {{"key", varied}}};
  seen.statuses[{"odd", ""}] = {20, 0, {{"key\nRULE z", varied}}};
  const RuleSet rules = rules_of(seen);
  EXPECT_EQ(rules.components.size(), 2u);
  EXPECT_THAT(rules.rules, testing::SizeIs(3)) << "of each component, and of the odd status";
}

// A motor that warms up and down, and counts.
RobotProfile motor() {
  RobotProfile seen = robot();
  link::StatusCourse& course = seen.statuses[{"base: motor 1", "m1"}];
  course.messages = 30;
  course.worst = 1;
  for (int i = 0; i < 30; ++i) {
    course.keys["temperature"].note(60 + i % 5);
    course.keys["uptime"].note(std::int64_t{i});
    course.keys["mode"].note(std::string("on"));
    course.keys["limit"].note(80.0);
    course.keys["power (W)"].note(i == 3 ? Value(std::string("-")) : Value(i % 3 * 1.0));
  }
  return seen;
}

TEST(Draft, ADiagnosticThatWasNoErrorIsReportedWhenItIs) {
  const RuleSet rules = rules_of(motor());
  const auto rule = std::ranges::find(rules.rules, "base_motor_1_error", &Rule::name);
  ASSERT_NE(rule, rules.rules.end()) << draft(motor());
  EXPECT_TRUE(rule->strategies.empty()) << "nothing is done about it";
  EXPECT_THAT(draft(motor()), HasSubstr("TRIGGER level(\"base: motor 1\") >= 2\n"));
}

TEST(Draft, ADiagnosticThatIsAnErrorNowIsAskedAbout) {
  RobotProfile seen = motor();
  seen.statuses.begin()->second.worst = 2;
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("RULE base_motor")));
  EXPECT_THAT(text, HasSubstr("# level(\"base: motor 1\"): it was an error meanwhile."));
}

TEST(Draft, WhatCulpritSaysOfItselfIsNoPartOfTheRobot) {
  RobotProfile seen = robot();
  seen.robot.nodes["/culprit"] = {.parameters = {}, .lifecycle = "", .pid = 20};
  seen.starts["/culprit"].command = {"/usr/bin/culprit", "run", "my.rules"};
  seen.robot.topics["/culprit/status"] = {"culprit_msgs/msg/Status", {"/culprit"}, {}, {}, {}};
  seen.rhythms["/culprit/status"] = {301, 30s, 110ms};
  const std::string before = draft(robot());
  for (const char* status : {"culprit", "culprit: lidar_failed", "culprit: component lidar"}) {
    link::StatusCourse& course = seen.statuses[{status, "culprit"}] = {30, 0, {}};
    for (int i = 0; i < 30; ++i) course.keys["failing"].note(std::int64_t{i % 2});
  }
  EXPECT_EQ(draft(seen), before);
  seen.statuses[{"culprit: of somebody else", "arm"}] = {30, 0, {}};
  EXPECT_THAT(draft(seen), HasSubstr("TRIGGER level(\"culprit: of somebody else\") >= 2\n"));
}

TEST(Draft, OfTwoDiagnosticsOfOneNameRulesNameTheHardware) {
  RobotProfile seen = motor();
  seen.statuses[{"base: motor 1", "m2"}] = {20, 0, {}};
  seen.statuses[{"both", ""}] = {20, 0, {}};
  seen.statuses[{"one", "both"}] = {20, 0, {}};
  const std::string text = draft(seen);
  EXPECT_THAT(text, HasSubstr("TRIGGER level(m1) >= 2\n"));
  EXPECT_THAT(text, HasSubstr("TRIGGER level(m2) >= 2\n"));
  EXPECT_THAT(text, HasSubstr("TRIGGER level(one) >= 2\n"));
  EXPECT_THAT(text, HasSubstr("# the diagnostic 'both': others are called so, too"));
  rules_of(seen);
}

TEST(Draft, OfKeysTheRangeIsProposedAndNothingOfWhatOnlyCountsOrStandsStill) {
  const std::string text = draft(motor());
  EXPECT_THAT(text, HasSubstr(R"(
# proposal: temperature of "base: motor 1" was 60 to 64, 30 times. Less than 16 % of its values are outside (95 % certain).
#   SIGNAL base_motor_1_temperature DIAGNOSTIC "base: motor 1" KEY temperature STALE 5s
#   RULE base_motor_1_temperature_unusual
#     POLICIES WARNING FOR 1s REPORT
#     TRIGGER base_motor_1_temperature < 56 || base_motor_1_temperature > 68
)"));
  EXPECT_THAT(text, Not(HasSubstr("uptime")));
  EXPECT_THAT(text, Not(HasSubstr("KEY mode")));
  EXPECT_THAT(text, Not(HasSubstr("KEY limit")));
  EXPECT_THAT(text, Not(HasSubstr("power")));
  EXPECT_THAT(rules_with_proposals(motor()).signals, testing::SizeIs(1));
}

TEST(Draft, WhatCommandsMovementsIsProposedAsAnInterlock) {
  RobotProfile seen = robot();
  seen.robot.topics["/cmd_vel"] = {"geometry_msgs/msg/Twist", {}, {}, {}, {}};
  seen.robot.topics["/arm/joint_trajectory"] = {
      "trajectory_msgs/msg/JointTrajectory", {"/lidar"}, {}, {}, {}};
  seen.robot.topics["/arm/commands"] = {"std_msgs/msg/Float64MultiArray", {"/lidar"}, {}, {}, {}};
  seen.robot.topics["/numbers"] = {"std_msgs/msg/Float64MultiArray", {"/lidar"}, {}, {}, {}};
  seen.fields["/cmd_vel"]["linear.x"] = {40, 0, -0.5, 0.25, 0, true, true};
  const std::string text = draft(seen);
  EXPECT_THAT(text,
              HasSubstr("# /cmd_vel (geometry_msgs/msg/Twist): 40 commands came, at most 0.5.\n"));
  EXPECT_THAT(text, HasSubstr("#   INTERLOCK age(/cmd_vel) > 1s || abs(cmd_vel_linear_x) + "));
  EXPECT_THAT(text, HasSubstr("#   INTERLOCK age(/arm/joint_trajectory) > 10s\n"));
  EXPECT_THAT(text, HasSubstr("#   INTERLOCK age(/arm/commands) > 10s\n"));
  EXPECT_THAT(text, Not(HasSubstr("INTERLOCK age(/numbers)")));
  EXPECT_TRUE(rules_of(seen).interlocks.empty()) << "it is for a person to decide";
  EXPECT_THAT(rules_with_proposals(seen).interlocks, testing::SizeIs(3));
}

}  // namespace
}  // namespace culprit::init
