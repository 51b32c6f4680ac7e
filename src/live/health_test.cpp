#include "live/health.h"

#include <gtest/gtest.h>

#include "base/tool_names.h"
#include "knowledge/attempts.h"
#include "language/checker.h"

namespace culprit::live {
namespace {

RuleSet two_rules() {
  return *check(Source("test.rules",
                       "COMPONENT c NODE /c\n"
                       "RULE A\nPOLICIES ERROR\nTRIGGER age(/t) > 1s\nSTRATEGY s 50 10\nADAPTATION "
                       "c restart 5\n"
                       "RULE B\nPOLICIES WARNING\nTRIGGER age(/t) > 2s\nSTRATEGY s 50 "
                       "10\nADAPTATION c restart 5\n"))
              .rules;
}

// A robot whose only component is there.
struct Present {
  Present() { knowledge.components[ComponentId(0)].alive = true; }

  const RuleSet rules = two_rules();
  Knowledge knowledge{rules};
};

TEST(HealthReport, IsOkWhileAllIsQuiet) {
  const Present robot;
  const Knowledge& knowledge = robot.knowledge;
  const auto all = health(knowledge);
  ASSERT_EQ(all.size(), 3u);
  for (const link::Health& status : all) EXPECT_EQ(status.level, 0) << status.name;
}

// culprit init knows by that what is none of the robot's.
TEST(HealthReport, IsKnownAsCulpritsOwn) {
  RuleSet rules = two_rules();
  rules.components[0].is_required = true;
  Knowledge knowledge(rules);
  knowledge.components[ComponentId(0)].alive = true;
  const auto all = health(knowledge);
  ASSERT_EQ(all.size(), 4u);
  for (const link::Health& status : all)
    EXPECT_TRUE(is_culprits_status(status.name, kCulpritsHardwareId)) << status.name;
}

TEST(HealthReport, WarnsOfAFailureUnderRepairAndErrsWhenNothingIsLeftToTry) {
  const RuleSet rules = two_rules();
  Knowledge knowledge(rules);
  knowledge.states.enter(RuleId(0), RulePhase::kFailing);
  EXPECT_EQ(health(knowledge)[0].level, 1);
  EXPECT_EQ(health(knowledge)[1].level, 1);
  EXPECT_EQ(health(knowledge)[2].level, 0);

  knowledge.states.enter(RuleId(0), RulePhase::kExhausted);
  const auto all = health(knowledge);
  EXPECT_EQ(all[0].level, 2);
  EXPECT_EQ(all[0].message, "0 failing, 1 exhausted");
  EXPECT_EQ(all[1].name, "culprit: A");
  EXPECT_EQ(all[1].level, 2);
}

// A person ordered it.
TEST(HealthReport, IsOkWhileAStrategyIsUnderWayWithoutAFailure) {
  Present robot;
  Knowledge& knowledge = robot.knowledge;
  Attempts(knowledge.states).begin(StrategyId(0), Time());
  const auto all = health(knowledge);
  EXPECT_EQ(all[0].level, 0);
  EXPECT_EQ(all[0].message, "all rules are quiet");
  EXPECT_EQ(all[1].level, 0);
  EXPECT_EQ(all[1].message, "quiet");
}

// As the page and `culprit status` do.
TEST(HealthReport, WarnsOfAComponentThatIsNotThere) {
  Present robot;
  ComponentState& state = robot.knowledge.components[ComponentId(0)];
  state.alive.reset();
  EXPECT_EQ(health(robot.knowledge)[0].level, 1);
  EXPECT_EQ(health(robot.knowledge)[0].message, "no failure is seen, but c is not seen yet");
  state.is_missed = true;
  EXPECT_EQ(health(robot.knowledge)[0].message, "no failure is seen, but c was never seen");
  state.alive = false;
  EXPECT_EQ(health(robot.knowledge)[0].level, 1);
  EXPECT_EQ(health(robot.knowledge)[0].message, "no failure is seen, but c is down");
}

// A deaf culprit judges nothing: no rule reads "quiet".
TEST(HealthReport, ErrsWhileCulpritIsDeafAndCallsNothingWell) {
  Present robot;
  robot.knowledge.states.enter(RuleId(1), RulePhase::kExhausted);
  const auto all = health(robot.knowledge, Reception::kLost);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].level, 2);
  EXPECT_EQ(all[0].message,
            "culprit does not receive the robot's messages; nothing is judged or done");
  EXPECT_EQ(all[1].level, 1);
  EXPECT_EQ(all[1].message, "not judged: culprit does not receive the robot's messages");
  EXPECT_EQ(all[2].message, "nothing could be tried; a person must look");
}

TEST(HealthReport, WarnsOfABlindRule) {
  const RuleSet rules = two_rules();
  Knowledge knowledge(rules);
  knowledge.blindness.set(RuleId(1), {Time(), Unseen::kNeverSeen, "/t", "/tf"});
  auto all = health(knowledge);
  EXPECT_EQ(all[0].level, 1);
  EXPECT_EQ(all[0].message, "no failure is seen, 1 blind");
  EXPECT_EQ(all[1].level, 0);
  EXPECT_EQ(all[2].level, 1);
  EXPECT_EQ(all[2].message, "blind: /t was never seen; did you mean '/tf'?");

  knowledge.blindness.set(RuleId(0), {Time(), Unseen::kNeverSeen, "/t", ""});
  EXPECT_EQ(health(knowledge)[0].message, "watching nothing: no rule can see");

  knowledge.states.enter(RuleId(0), RulePhase::kFailing);
  all = health(knowledge);
  EXPECT_EQ(all[0].message, "1 failing, 0 exhausted, 2 blind");
}

TEST(HealthReport, ErrsWhenARequiredComponentIsNotThere) {
  const RuleSet rules = *check(Source("test.rules", "COMPONENT a REQUIRED\nCOMPONENT b\n")).rules;
  Knowledge knowledge(rules);
  EXPECT_EQ(health(knowledge).size(), 1u) << "it may still be discovered";
  for (const ComponentId id : {ComponentId(0), ComponentId(1)})
    knowledge.components[id].is_missed = true;
  auto all = health(knowledge);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].level, 2);
  EXPECT_EQ(all[1].name, "culprit: component a");
  EXPECT_EQ(all[1].level, 2);
  knowledge.components[ComponentId(0)].is_missed = false;
  knowledge.components[ComponentId(0)].alive = true;
  all = health(knowledge);
  EXPECT_EQ(all[0].level, 1) << "b was never seen, either";
  EXPECT_EQ(all[1].level, 0);
  knowledge.components[ComponentId(1)].alive = true;
  EXPECT_EQ(health(knowledge)[0].level, 0);
}

}  // namespace
}  // namespace culprit::live
