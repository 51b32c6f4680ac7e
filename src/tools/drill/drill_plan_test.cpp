#include "drill/drill_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::drill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

RuleSet planned_rules() {
  return *check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT viewer NODE /viewer
COMPONENT remote NODE /remote UNIT remote.service HOST robot@rover2
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 10
)"))
              .rules;
}

std::vector<std::string> ids_of(const DrillPlan& plan) {
  std::vector<std::string> ids;
  for (const Step& step : plan.steps) ids.push_back(step.id());
  return ids;
}

TEST(DrillPlan, BreaksOnlyWhatAnOwnerOnThisComputerCanStartAgain) {
  const auto made = plan(planned_rules(), {.kinds = {FaultKind::kKill}});
  ASSERT_TRUE(made);
  EXPECT_THAT(ids_of(*made), UnorderedElementsAre("kill camera #1", "kill fusion #1"));
  EXPECT_THAT(made->left_out,
              ElementsAre(testing::Pair("remote", "it runs on another computer"),
                          testing::Pair("viewer", HasSubstr("no owner can start it again"))));
}

TEST(DrillPlan, LeavesAloneWhatItsOwnerCouldNotStartNow) {
  const auto made = plan(planned_rules(), {.kinds = {FaultKind::kKill},
                                           .spared = {{"camera", "there is no program camera"}}});
  ASSERT_TRUE(made);
  EXPECT_THAT(ids_of(*made), ElementsAre("kill fusion #1"));
  EXPECT_EQ(made->left_out.at("camera"), "there is no program camera");
}

TEST(DrillPlan, TheSeedDecidesTheOrderAndEachRoundHasEveryFaultOnce) {
  const PlanOptions options{.times = 3, .seed = 7};
  const auto ids = ids_of(*plan(planned_rules(), options));
  EXPECT_EQ(ids, ids_of(*plan(planned_rules(), options)));
  EXPECT_NE(ids, ids_of(*plan(planned_rules(), {.times = 3, .seed = 8})));
  ASSERT_EQ(ids.size(), 30u);
  const std::set<std::string> first(ids.begin(), ids.begin() + 10);
  EXPECT_EQ(first.size(), 10u);
  for (const std::string& id : first) EXPECT_THAT(id, HasSubstr("#1"));
}

TEST(DrillPlan, ABudgetCutsTheLastRounds) {
  const auto all = plan(planned_rules(), {.times = 4});
  const auto part = plan(planned_rules(), {.times = 4, .budget = all->estimate / 2});
  EXPECT_LE(part->estimate, all->estimate / 2);
  EXPECT_EQ(part->steps.size() + part->beyond_budget, all->steps.size());
  EXPECT_THAT(ids_of(*part).back(), HasSubstr("#2"));
}

TEST(DrillPlan, PairsAreKilledAtOnce) {
  const auto made = plan(planned_rules(), {.kinds = {FaultKind::kKill}, .pairs = true});
  EXPECT_THAT(ids_of(*made), testing::Contains("kill camera + kill fusion #1"));
}

TEST(DrillPlan, APairKillsNoComponentThatTheRulesKeepFromIt) {
  const RuleSet rules = *check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT motor NODE /motor LAUNCH "motor"
DRILL motor without kill
)"))
                             .rules;
  const auto made = plan(rules, {.kinds = {FaultKind::kHang}, .pairs = true});
  ASSERT_TRUE(made);
  EXPECT_THAT(ids_of(*made), UnorderedElementsAre("hang camera #1", "hang fusion #1",
                                                  "hang motor #1", "kill camera + kill fusion #1"));
}

TEST(DrillPlan, ALimitCountsFaultsThatProvedNothing) {
  const RuleSet rules = *check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
DRILL camera limit 2
)"))
                             .rules;
  const Step step{{Fault{FaultKind::kHang, "camera"}}, 2};
  Trial aborted{{Fault{FaultKind::kKill, "camera"}}, 1, 100};
  aborted.trouble = "ABORT speed > 0.5 is true";
  Trial refused = aborted;
  refused.injected = 0;  // nothing was done to the component
  EXPECT_EQ(limit_reached(step, {aborted, refused, refused}, rules), "");
  EXPECT_EQ(limit_reached(step, {aborted, refused, aborted}, rules), "DRILL camera limit 2");
  EXPECT_EQ(limit_reached({{Fault{FaultKind::kKill, "fusion"}}, 1}, {aborted, aborted}, rules), "");
}

TEST(DrillPlan, DrillLinesAddExcludeAndLimit) {
  const RuleSet rules = *check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT motor NODE /motor LAUNCH "motor"
DRILL camera set_parameter exposure -0.5
DRILL camera without hang
DRILL camera without slow
DRILL fusion limit 2
DRILL motor limit 0
)"))
                             .rules;
  const auto made = plan(rules, {.times = 2});
  ASSERT_TRUE(made);
  std::map<std::string, int> times;
  for (const Step& step : made->steps) ++times[step.faults[0].component];
  EXPECT_THAT(times, ElementsAre(testing::Pair("camera", 8), testing::Pair("fusion", 2)));
  EXPECT_THAT(ids_of(*made), testing::IsSupersetOf({"set_parameter camera exposure -0.5 #1",
                                                    "kill camera #2", "deactivate camera #1"}));
  EXPECT_THAT(made->left_out,
              ElementsAre(testing::Pair("motor", "the rules say DRILL motor limit 0")));
}

TEST(DrillPlan, NamesThatTheRulesDoNotHaveAreErrors) {
  const auto made = plan(planned_rules(), {.only = {"camra"}});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), "the rules have no component 'camra'; did you mean 'camera'?");
}

TEST(DrillPlan, ADrillLineOfAComponentThatIsNotDeclaredIsAnError) {
  const RuleSet rules = *check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
DRILL camra limit 0
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 10
)"))
                             .rules;
  const auto made = plan(rules, {});
  ASSERT_FALSE(made) << "it was to spare the camera";
  EXPECT_EQ(made.error(),
            "DRILL camra: the rules have no component 'camra'; did you mean 'camera'?");
}

}  // namespace
}  // namespace culprit::drill
