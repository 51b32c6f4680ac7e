#include "init/draft.h"

#include "language/checker.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// A camera of 20 Hz that a person started, and a lidar of 10 Hz that systemd did.
Sighting robot() {
  Sighting seen;
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

RuleSet rules_of(const Sighting& seen) {
  const std::string text = draft(seen);
  const Checked checked = check({"draft", text});
  EXPECT_THAT(checked.diagnostics, testing::IsEmpty()) << text;
  return checked.rules ? *checked.rules : RuleSet{};
}

const Component& component(const RuleSet& rules, const std::string& name) {
  return *std::ranges::find(rules.components, name, &Component::name);
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
  EXPECT_EQ(
      draft(robot()),
      R"(# Drafted by `culprit init` from what domain 7 showed in 30s, while it was taken to be well.
# What culprit guessed is marked "guess". Read it, then try it: culprit run --dry-run FILE

CYCLE 200ms

# guess: process 9 (bash) started camera. If it starts again what ends, write RESPAWNED.
# Variables of theirs that are not copied, for they may be secrets: API_KEY
COMPONENT lidar NODE /lidar UNIT lidar.service
COMPONENT camera NODE /robot/camera LAUNCH "/opt/cam/driver --name 'front left'" ENV "ROS_DOMAIN_ID=7" CWD "/home/robot/my data"

# guess: /scan came 10 times a second, 301 messages, at most 130ms apart.
# Less than 1 % of its pauses are longer (95 % certain); silence is 3 times that, 300ms at least.
RULE lidar_failed
  POLICIES ERROR
  TRIGGER !alive(lidar) || age(/scan) > 500ms
    # guess: how often it helps, in percent; culprit learns that from every attempt
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 25

# guess: /robot/image came 20 times a second, 601 messages, at most 70ms apart.
# Less than 0.5 % of its pauses are longer (95 % certain); silence is 3 times that, 300ms at least.
RULE camera_failed
  POLICIES ERROR
  TRIGGER !alive(camera) || age(/robot/image) > 300ms
    # guess: how often it helps, in percent; culprit learns that from every attempt
    STRATEGY camera_restart 50 10
      ADAPTATION camera restart 10
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 25
)");
}

TEST(Draft, NothingThatAProcessWasStartedWithIsReadAsAnythingElse) {
  Sighting seen = robot();
  const std::vector<std::string> odd = {"/opt/cam/driver", "it's",  "a\"b", "c\\d",
                                        "two\nlines",      "\ttab", "",     "$HOME",
                                        "# no comment"};
  seen.starts["/robot/camera"].command = odd;
  EXPECT_EQ(component(rules_of(seen), "camera").launch, odd);
}

TEST(Draft, OfTwoNodesOfOneNameEachHasItsOwn) {
  Sighting seen = robot();
  seen.robot.nodes["/left/camera"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/left/camera"].command = {"/opt/cam/driver", "left"};
  const RuleSet rules = rules_of(seen);
  EXPECT_EQ(component(rules, "left_camera").node, "/left/camera");
  EXPECT_EQ(component(rules, "robot_camera").node, "/robot/camera");
}

TEST(Draft, AWordOfTheLanguageIsNoName) {
  Sighting seen = robot();
  seen.robot.nodes["/RULE"] = {.parameters = {}, .lifecycle = "", .pid = 13};
  seen.starts["/RULE"].command = {"/opt/rule"};
  EXPECT_EQ(component(rules_of(seen), "RULE_node").node, "/RULE");
}

TEST(Draft, WhatCannotBeStartedAgainIsListedWithTheReason) {
  Sighting seen = robot();
  seen.robot.nodes["/far"] = {};
  seen.robot.nodes["/part"] = {.parameters = {}, .lifecycle = "", .pid = 12};
  seen.starts["/part"] = seen.starts["/robot/camera"];
  const std::string text = draft(seen);
  EXPECT_THAT(text, HasSubstr("# /far: its process is not on this machine"));
  EXPECT_THAT(text, HasSubstr("# /part: it lives in process 12 with /lidar."));
  EXPECT_THAT(text, HasSubstr("# /lidar: it lives in process 12 with /part."));
  EXPECT_THAT(text, Not(HasSubstr("COMPONENT lidar")));
}

TEST(Draft, WithoutARhythmThereIsNoSilence) {
  Sighting seen = robot();
  seen.rhythms["/robot/image"] = {9, 30s, 4s};
  seen.rhythms["/scan"] = {100, 30s, 20s};
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("age(")));
  EXPECT_THAT(text, HasSubstr("# /robot/image: 9 messages came, too few for a rhythm"));
  EXPECT_THAT(text, HasSubstr("# /scan: it has no rhythm: 100 messages"));
  EXPECT_THAT(text, HasSubstr("!alive(camera)"));
}

TEST(Draft, TheSilenceOfATopicOfSeveralNodesIsNobodys) {
  Sighting seen = robot();
  seen.robot.topics["/scan"].publishers.insert("/robot/camera");
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("age(/scan)")));
  EXPECT_THAT(text, HasSubstr("# /scan: several nodes publish it"));
}

TEST(Draft, ToolsAndNamesThatRosDoesNotTakeAreNoComponents) {
  Sighting seen = robot();
  for (const char* name : {"/rviz2", "/_ros2cli_4711", "/launch_ros_12", "/bad name\nRULE x"}) {
    seen.robot.nodes[name] = {.parameters = {}, .lifecycle = "", .pid = 20};
    seen.starts[name] = seen.starts["/robot/camera"];
  }
  seen.robot.diagnostics.push_back({"evil\nRULE y", "", 0, {{"key\nRULE z", "1"}}});
  EXPECT_EQ(rules_of(seen).components.size(), 2u);
}

}  // namespace
}  // namespace culprit::init
