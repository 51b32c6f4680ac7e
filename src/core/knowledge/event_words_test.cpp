#include "knowledge/event_words.h"

#include <gtest/gtest.h>

#include "knowledge/describe.h"
#include "language/checker.h"

namespace culprit {
namespace {

// The compiler checks that each event has words, and a name of its own, where it compiles the
// table.
TEST(EventWords, AreFoundByEventByTypeAndByName) {
  const Event event{{}, StrategyChosen{}};
  EXPECT_EQ(words_of(event).name, "strategy_chosen");
  EXPECT_EQ(&words_of(event), &words_of<StrategyChosen>());
  EXPECT_EQ(kind_named("strategy_chosen"), kKindOf<StrategyChosen>);
  EXPECT_EQ(kind_named("decided"), std::nullopt) << "a label is no name";
  EXPECT_EQ(kind_named(""), std::nullopt);
}

TEST(EventWords, WhatIsRequiredAndNotThereIsAnError) {
  const RuleSet rules = *check(Source("test",
                                      "COMPONENT base NODE /base REQUIRED\n"
                                      "COMPONENT camera NODE /camera\n"))
                             .rules;
  const ComponentId base(0);
  const ComponentId camera(1);
  EXPECT_EQ(severity_of({{}, ComponentLost{base, ""}}, rules), EventSeverity::kError);
  EXPECT_EQ(severity_of({{}, ComponentLost{camera, ""}}, rules), EventSeverity::kWarning);
  EXPECT_EQ(severity_of({{}, NeverSeen{base, ""}}, rules), EventSeverity::kError);
  EXPECT_EQ(severity_of({{}, NeverSeen{camera, ""}}, rules), EventSeverity::kWarning);
  EXPECT_EQ(severity_of({{}, StormBegan{}}, rules), EventSeverity::kError);
  EXPECT_EQ(severity_of({{}, ComponentFound{base, 1}}, rules), EventSeverity::kInfo);
}

TEST(EventWords, ARuleThatOnlyReportsLacksNoRepair) {
  const RuleSet rules = *check(Source("test",
                                      "RULE Low\n  POLICIES ERROR REPORT\n  TRIGGER x > 1\n"
                                      "RULE High\n  POLICIES ERROR\n  TRIGGER y > 1\n"
                                      "    STRATEGY s 90 10\n      ADAPTATION c restart 5\n"))
                             .rules;
  const auto cleared = [&](std::uint32_t rule) {
    FailureResolved how{RuleId(rule), FailureResolved::How::kWithoutStrategy, std::nullopt,
                        std::chrono::seconds(2)};
    return describe({{}, how}, rules);
  };
  EXPECT_EQ(cleared(0), "Low cleared after 2.00 s");
  EXPECT_EQ(cleared(1), "High cleared without a repair of its own after 2.00 s");
}

TEST(EventWords, NameTheSignalThatBringsNoNewValue) {
  const auto stale = [](const std::string& input) {
    return describe(Blind{Time(), Unseen::kStale, input, ""});
  };
  EXPECT_EQ(stale("battery"), "no new value of battery comes");
  EXPECT_EQ(stale("changed(m)"), "no new value of m comes");
  EXPECT_EQ(stale("mean(battery, 10s)"), "no new value of battery comes");
  EXPECT_EQ(stale("parameter(camera, gain)"), "no new value of parameter(camera, gain) comes");
}

// No strategy was tried that could have helped.
TEST(EventWords, ARuleWithNothingButALastResortTriesNothing) {
  const RuleSet rules = *check(Source("test",
                                      "RULE Lost\n  POLICIES ERROR\n  TRIGGER x > 1\n"
                                      "    STRATEGY halt 90 10 LASTRESORT\n"
                                      "      ADAPTATION base deactivate 5\n"))
                             .rules;
  EXPECT_EQ(describe({{}, RoundSpent{RuleId(0), {}}}, rules),
            "Lost has no strategy besides its last resort");
  EXPECT_EQ(
      describe({{}, RuleExhausted{RuleId(0)}}, rules),
      "Lost is exhausted: it has no strategy besides its last resort, and a person must look");
}

TEST(EventWords, NameTheOwnerThatStartsAndEnds) {
  const RuleSet rules = *check(Source("test",
                                      "COMPONENT own NODE /own LAUNCH \"own\"\n"
                                      "COMPONENT lidar NODE /lidar UNIT lidar.service\n"
                                      "COMPONENT slam NODE /slam CONTAINER podman slam_1\n"
                                      "COMPONENT part NODE /part IN /box PLUGIN a::B\n"
                                      "COMPONENT radar NODE /radar RESPAWNED\n"
                                      "COMPONENT far NODE /far UNIT far.service HOST ann@rover2\n"))
                             .rules;
  const auto redeploys = [&](std::uint32_t component) {
    Adaptation adaptation{};
    adaptation.component = ComponentId(component);
    adaptation.type = AdaptationType::kRedeploy;
    return describe(adaptation, rules);
  };
  EXPECT_EQ(redeploys(0), "redeploy own");
  EXPECT_EQ(redeploys(1), "redeploy lidar (lidar.service)");
  EXPECT_EQ(redeploys(2), "redeploy slam (podman slam_1)");
  EXPECT_EQ(redeploys(3), "redeploy part (in /box)");
  EXPECT_EQ(redeploys(4), "redeploy radar (respawned)");
  EXPECT_EQ(redeploys(5), "redeploy far (far.service on ann@rover2)");
}

TEST(EventWords, SayWhatADecisionEndsBesides) {
  const RuleSet rules = *check(Source("test",
                                      "COMPONENT box NODE /box LAUNCH \"box\"\n"
                                      "COMPONENT one NODE /one\nCOMPONENT two NODE /two\n"
                                      "RULE Gone\nPOLICIES ERROR\nTRIGGER !alive(box)\n"
                                      "STRATEGY again 90 10\nADAPTATION box redeploy 5\n"))
                             .rules;
  StrategyChosen chosen{};
  chosen.strategy = StrategyId(0);
  chosen.also_ended = {ComponentId(1), ComponentId(2)};
  EXPECT_EQ(describe({{}, chosen}, rules),
            "box is held responsible for Gone: redeploy box, which also ends one and two (again)");
}

}  // namespace
}  // namespace culprit
