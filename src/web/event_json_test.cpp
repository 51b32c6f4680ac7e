#include "web/event_json.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera REQUIRED
COMPONENT fusion NODE /fusion
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY restart_camera 50 10
      ADAPTATION camera restart 3
RULE FusionGone
  POLICIES ERROR
  TRIGGER alive(fusion) == false
    STRATEGY restart_fusion 50 10
      ADAPTATION fusion restart 3
)";

TEST(EventJson, HasTheWordsOfTheJournalAndWhatAPageShows) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  const StrategyId restart(1);
  const Candidate waits{restart, 0.5, Condition::kDependency, ComponentId(0), RuleId(0), "", 0, 0};
  const Json json = to_json(Event{Time(3s), FailureHeldBack{RuleId(1), {waits}}}, rules, Time(1s));
  EXPECT_EQ(json["t"], 2.0);
  EXPECT_EQ(json["type"], "failure_held_back");
  EXPECT_EQ(json["label"], "waiting");
  EXPECT_EQ(json["severity"], "info");
  EXPECT_EQ(json["tone"], "aside");
  EXPECT_EQ(json["rule"], "FusionGone");
  EXPECT_FALSE(json.contains("time"));
  const Json& excluded = json["candidates"][0]["excluded"];
  EXPECT_EQ(excluded["condition"], "dependency");
  EXPECT_EQ(excluded["component"], "camera");
  EXPECT_EQ(excluded["failure"], "CameraGone");
  EXPECT_EQ(excluded["text"], "it depends on camera, which may be the cause (CameraGone)");
}

TEST(EventJson, SaysWhatWouldEndAWait) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  Candidate waits{StrategyId(1), 0.5, Condition::kSuspect, ComponentId(0), std::nullopt, ""};
  const auto end = [&] {
    const Json json =
        to_json(Event{Time(3s), FailureHeldBack{RuleId(1), {waits}}}, rules, Time(1s));
    return json["candidates"][0]["excluded"].value("ends", "");
  };
  EXPECT_EQ(end(), "") << "that is not known";
  waits.within = 600ms;
  EXPECT_EQ(end(), "if camera does not answer within 0.60 s, camera is held responsible");
  waits.failure = RuleId(0);
  EXPECT_EQ(end(), "if CameraGone does not fire within 0.60 s, fusion is held responsible");
  waits.excluded = Condition::kDependency;
  EXPECT_EQ(end(), "if camera is not back within 0.60 s, fusion is held responsible");
}

TEST(EventJson, TellsWhatAChosenStrategyDoesAndToWhichComponents) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  const Json json = to_json(Event{Time(1s), StrategyChosen{StrategyId(0), {}, {}}}, rules, Time());
  EXPECT_EQ(json["strategy"], "restart_camera");
  EXPECT_EQ(json["components"], Json::array({"camera"}));
  EXPECT_EQ(json["actions"], Json::array({"restart camera"}));
  EXPECT_EQ(json["dry_run"], false);
}

TEST(EventJson, IsAsSevereAsItIsInRosout) {
  const RuleSet rules = *check(Source("test", kRules)).rules;
  const auto severity = [&](ComponentId component) {
    return to_json(Event{{}, ComponentLost{component, ""}}, rules, Time())["severity"];
  };
  EXPECT_EQ(severity(ComponentId(0)), "error") << "it is REQUIRED";
  EXPECT_EQ(severity(ComponentId(1)), "warning");
}

}  // namespace
}  // namespace culprit::web
