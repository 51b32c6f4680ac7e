// Dumps in both of play_launch's forms, and drafts from them.
#include "init/launch_dump.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "init/draft.h"
#include "language/checker.h"

namespace culprit::init {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;

constexpr const char* kModel = R"(
meta: {version: 1}
structure:
  nodes:
    /box: {pkg: rclcpp_components, exec: component_container_mt, node_name: box, respawn: true, is_container: true}
    /left/camera:
      pkg: my_cameras
      plugin: cameras::Driver
      container: /box
      params: {rate: 10.0, frame: left lens, use_sim_time: 'False', names: [a, b]}
      remaps:
      - {from: image, to: /left/image}
    /detect: {pkg: detect, plugin: detect::Detector, container: /box, node_name: detect}
)";

constexpr const char* kRecord = R"({
  "container": [{"executable": "component_container_mt", "package": "rclcpp_components", "name": "box",
                 "namespace": "/", "params": [], "params_files": [], "remaps": [], "cmd": [], "respawn": true}],
  "load_node": [
    {"package": "my_cameras", "plugin": "cameras::Driver", "target_container_name": "/box",
     "node_name": "camera", "namespace": "/left", "params": [["rate", "10.0"], ["frame", "left lens"]],
     "remaps": [["image", "/left/image"]], "extra_args": {}},
    {"package": "detect", "plugin": "detect::Detector", "target_container_name": "/box",
     "node_name": "detect", "namespace": "/", "params": [], "remaps": [], "extra_args": {}}],
  "node": [], "lifecycle_node": [], "file_data": {}
})";

TEST(LaunchDump, SaysHowNodesAreLoaded) {
  for (const char* text : {kModel, kRecord}) {
    const auto dump = read_launch_dump(text, "robot.dump");
    ASSERT_TRUE(dump) << dump.error();
    EXPECT_THAT(dump->respawned, ElementsAre("/box"));
    const Recipe& camera = dump->recipes.at("/left/camera");
    EXPECT_EQ(camera.container, "/box");
    EXPECT_EQ(camera.package, "my_cameras");
    EXPECT_EQ(camera.plugin, "cameras::Driver");
    EXPECT_THAT(camera.remaps, ElementsAre(Pair("image", "/left/image")));
    EXPECT_THAT(camera.parameters,
                testing::IsSupersetOf({Pair("rate", "10.0"), Pair("frame", "\"left lens\"")}));
    EXPECT_EQ(dump->recipes.at("/detect").plugin, "detect::Detector");
  }
  EXPECT_THAT(
      read_launch_dump(kModel, "")->recipes.at("/left/camera").parameters,
      testing::IsSupersetOf({Pair("use_sim_time", "False"), Pair("names", R"(["a", "b"])")}));
}

TEST(LaunchDump, MayMarkTextsThatLookLikeNumbers) {
  const auto dump = read_launch_dump(
      R"({"load_node": [{"plugin": "a::B", "node_name": "c", "target_container_name": "/box", "namespace": "/",
          "params": [["id", "7", "text"], ["ids", ["1", "on"], "text"], ["rate", 7], ["is_on", true]]}]})",
      "");
  ASSERT_TRUE(dump) << dump.error();
  EXPECT_THAT(dump->recipes.at("/c").parameters,
              ElementsAre(Pair("id", "\"7\""), Pair("ids", R"(["1", "on"])"), Pair("rate", "7"),
                          Pair("is_on", "true")));
}

TEST(LaunchDump, OfSomethingElseIsAnError) {
  EXPECT_THAT(read_launch_dump("a: [", "x.yaml").error(), HasSubstr("x.yaml:1: "));
  for (const char* text : {"", "7", "[]", "a: b", "structure: 7", "structure: {nodes: 7}",
                           "load_node: 7", "load_node: [7]", "node: {a: 1}",
                           "load_node: [{plugin: a::B, node_name: c, params: [[1]]}]"}) {
    const auto dump = read_launch_dump(text, "x.yaml");
    EXPECT_TRUE(!dump || dump->recipes.empty()) << text;
  }
  EXPECT_THAT(read_launch_dump("a: b", "x.yaml").error(), HasSubstr("is no dump of a launch file"));
}

RobotProfile composed_robot() {
  RobotProfile seen;
  seen.looked = std::chrono::seconds(30);
  for (const char* node : {"/box", "/left/camera", "/detect"})
    seen.robot.nodes[node] = {.parameters = {}, .lifecycle = "", .pid = 11};
  seen.starts["/box"].command = {"/opt/component_container_mt"};
  seen.starts["/left/camera"] = seen.starts["/detect"] = seen.starts["/box"];
  return seen;
}

TEST(DraftFromALaunchDump, DeclaresWhatAContainerLoads) {
  RobotProfile seen = composed_robot();
  seen.dump = *read_launch_dump(kModel, "");
  seen.parameter_file = "/rules/my.params.yaml";
  const std::string text = draft(seen);
  const Checked checked = check({"draft", text});
  EXPECT_THAT(checked.diagnostics, testing::IsEmpty()) << text;
  EXPECT_THAT(text, HasSubstr("NODE /box LAUNCH \"/opt/component_container_mt\" RESPAWNED\n"));
  EXPECT_THAT(text,
              HasSubstr("NODE /left/camera IN /box PLUGIN cameras::Driver PACKAGE my_cameras "
                        "PARAMETERS \"/rules/my.params.yaml\" REMAP \"image:=/left/image\"\n"));
  EXPECT_THAT(text, HasSubstr("NODE /detect IN /box PLUGIN detect::Detector\n"));
  EXPECT_THAT(parameters_text(seen), HasSubstr("/left/camera:\n  ros__parameters:\n"));
  EXPECT_THAT(parameters_text(seen), HasSubstr("    \"frame\": \"left lens\"\n"));
}

// A container that is replaced has to have all again that it had.
TEST(DraftFromALaunchDump, LeavesAContainerOutWhereItDoesNotKnowAllThatItLoads) {
  RobotProfile seen = composed_robot();
  seen.dump = *read_launch_dump(kModel, "");
  seen.dump.recipes.erase("/detect");
  const std::string text = draft(seen);
  EXPECT_THAT(text, Not(HasSubstr("\nCOMPONENT")));
  EXPECT_THAT(text, HasSubstr("or give a dump of its launch file: --launch"));
  EXPECT_EQ(parameters_text(seen), "");
}

// As Nav2's servers do, which make the nodes of their costmaps.
TEST(DraftFromARunningLaunch, TakesOtherNodesOfTheContainerForPartsOfItsComponents) {
  RobotProfile seen = composed_robot();
  seen.robot.services["/box/_container/load_node"] = "composition_interfaces/srv/LoadNode";
  seen.robot.nodes["/left/costmap"] = {.parameters = {}, .lifecycle = "", .pid = 11};
  seen.starts["/left/costmap"] = seen.starts["/box"];
  seen.parameter_file = "/rules/my.params.yaml";
  seen.dump = *read_launch_dump(kRecord, "");
  EXPECT_THAT(draft(seen), Not(HasSubstr("\nCOMPONENT")));
  seen.dump.is_of_running = true;
  const std::string text = draft(seen);
  EXPECT_THAT(check({"draft", text}).diagnostics, testing::IsEmpty()) << text;
  EXPECT_THAT(text, HasSubstr("COMPONENT box NODE /box LAUNCH "));
  EXPECT_THAT(text, HasSubstr("NODE /left/camera IN /box PLUGIN cameras::Driver"));
  EXPECT_THAT(text, HasSubstr("# /left/costmap: a component in /box made it\n"));
}

}  // namespace
}  // namespace culprit::init
