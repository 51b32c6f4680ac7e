#include "modes/read_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::modes {
namespace {

using ::testing::ElementsAre;

constexpr const char* kRobot = R"(---
actuation:
  ros__parameters:
    type: system
    parts:
      drive_base
      left/arm
    modes:
      __DEFAULT__:
        drive_base: active
        left/arm: inactive
      FAST:
        drive_base: active.FAST
    rules:
      slow_down:
        if_target: active.FAST
        if_part: [left/arm, active.__DEFAULT__]
        new_target: active
drive_base:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__:
        ros__parameters: {speed: 0.1, controller: PID, is_on: yes, gears: 3, code: "7"}
      FAST:
        ros__parameters: {speed: 0.9}
left:
  arm:
    ros__parameters:
      type: node
      modes:
        __DEFAULT__:
          ros__parameters: {torque: 1.0}
)";

Model read(const std::string& text) {
  auto model = read_model("robot.yaml", text);
  if (!model) throw std::runtime_error(model.error());
  return *model;
}

// `from` in the robot's model replaced; and what is said about it.
std::string error_with(const std::string& from, const std::string& to) {
  std::string text = kRobot;
  const auto at = text.find(from);
  if (at == std::string::npos) return "the robot has no '" + from + "'";
  const auto model = read_model("robot.yaml", text.replace(at, from.size(), to));
  return model ? "" : model.error();
}

TEST(ReadModel, PutsPartsBeforeTheirSystems) {
  std::vector<std::string> names;
  for (const Entity& entity : read(kRobot).entities) names.push_back(entity.name);
  EXPECT_THAT(names, ElementsAre("/drive_base", "/left/arm", "/actuation"));
}

TEST(ReadModel, LetsModesBeginAsACopyOfTheDefault) {
  const Model model = read(kRobot);
  const Mode& fast = *model.find("/actuation")->find("FAST");
  EXPECT_EQ(fast.parts.at("/drive_base"), (Target{true, "FAST"}));
  EXPECT_EQ(fast.parts.at("/left/arm"), (Target{false, ""}));
  const Mode& base = *model.find("/drive_base")->find("FAST");
  EXPECT_EQ(base.parameters.at("speed"), Value(0.9));
  EXPECT_EQ(base.parameters.at("controller"), Value(std::string("PID")));
}

TEST(ReadModel, ReadsValuesAsParameterFilesDo) {
  const Model model = read(kRobot);
  const auto& parameters = model.find("/drive_base")->modes.front().parameters;
  EXPECT_EQ(parameters.at("is_on"), Value(true));
  EXPECT_EQ(parameters.at("gears"), Value(std::int64_t{3}));
  EXPECT_EQ(parameters.at("code"), Value(std::string("7")));
}

TEST(ReadModel, ReadsRules) {
  const Model model = read(kRobot);
  const Rule& rule = model.find("/actuation")->rules.front();
  EXPECT_EQ(rule.part, "/left/arm");
  EXPECT_EQ(to_string(rule.if_target), "active.FAST");
  EXPECT_EQ(to_string(rule.new_target), "active.__DEFAULT__");
}

TEST(ReadModel, SaysWhereWhatIsWrong) {
  EXPECT_EQ(error_with("      __DEFAULT__:\n        drive_base", "      SLOW:\n        drive_base"),
            "robot.yaml:9:7: /actuation has no __DEFAULT__ as its first mode; the others begin as "
            "copies of it");
  EXPECT_EQ(error_with("active.FAST", "active.FAZT"),
            "robot.yaml:13:21: /drive_base has no mode FAZT; did you mean FAST?");
  EXPECT_EQ(error_with("        drive_base: active\n", "        drive_bass: active\n"),
            "robot.yaml:10:9: drive_bass is no part of /actuation; did you mean /drive_base?");
  EXPECT_EQ(error_with("drive_base: active\n", "drive_base: ACTIVE\n"),
            "robot.yaml:10:21: 'ACTIVE' is no state; there are inactive, active and active.MODE");
  EXPECT_EQ(error_with("        left/arm: inactive\n", ""),
            "robot.yaml:10:9: /actuation, mode __DEFAULT__ says nothing about /left/arm");
  EXPECT_EQ(
      error_with("{speed: 0.9}", "{sped: 0.9}"),
      "robot.yaml:26:27: /drive_base, mode FAST sets sped, which __DEFAULT__ does not; add it "
      "there");
  EXPECT_EQ(error_with("{speed: 0.9}", "{speed: 9}"),
            "robot.yaml:26:34: /drive_base, mode FAST: speed is of another type than in "
            "__DEFAULT__");
  EXPECT_EQ(error_with("type: node", "type: mode"),
            "robot.yaml:21:11: type is 'mode'; there are 'system' and 'node'");
  EXPECT_EQ(error_with("left:\n  arm:", "left:\n  leg:"),
            "robot.yaml:2:1: /left/arm, a part of /actuation, has no entry; did you mean "
            "/left/leg?");
}

TEST(ReadModel, TakesNoSystemThatIsAPartOfItself) {
  const auto system = [](const std::string& name, const std::string& part) {
    return name + ": {ros__parameters: {type: system, parts: [" + part +
           "], modes: {__DEFAULT__: {" + part + ": active}}}}\n";
  };
  const auto model =
      read_model("circle.yaml", system("a", "b") + system("b", "c") + system("c", "b"));
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error(), "circle.yaml:2:1: /b is a part of itself: /b -> /c -> /b");
}

TEST(ReadModel, TakesNothingThatIsNoModel) {
  for (const char* text : {"", "[]", "a: [", "a", "a: {b: {c: 1}}", "\xff", "*a", "&a [*a]"}) {
    const auto model = read_model("x.yaml", text);
    ASSERT_FALSE(model) << text;
    EXPECT_TRUE(model.error().starts_with("x.yaml:")) << model.error();
  }
}

}  // namespace
}  // namespace culprit::modes
