#include "rca_study/timing_planners.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "rca_study/campaign.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

// b reads what a publishes; b's detector is 0.2 s late, a's is 2 s late.
RcaScenario pair() {
  RcaScenario scenario = generate({2, 1, 0, false}, 1);
  scenario.topics = {{"/a", {0}, {{1, 1, 0.5, false}}}};
  scenario.components[0].detector.latency_s = 2;
  scenario.components[1].detector.latency_s = 0.2;
  return scenario;
}

class TimingPlanners : public testing::Test {
 protected:
  TimingPlanners() : rules_(rules_of(scenario_)), knowledge_(rules_) {
    for (const std::string node : {"/c0", "/c1"}) knowledge_.graph.node_appeared(node);
    knowledge_.graph.endpoint_appeared("/c0", EndpointKind::kPublisher, "/a");
    knowledge_.graph.endpoint_appeared("/c1", EndpointKind::kSubscriber, "/a");
    for (const std::size_t c : {0, 1}) {
      ComponentState& component = knowledge_.components[ComponentId(c)];
      component.alive = true;
      component.process = ProcessState::kRunning;
      component.lifecycle = Lifecycle::kActive;
    }
  }

  void fails(std::size_t rule, Duration at) {
    knowledge_.states.state(RuleId(rule)).failing_since = Time(at);
    knowledge_.states.enter(RuleId(rule), RulePhase::kFailing);
  }
  void clears(std::size_t rule, Duration at) {
    knowledge_.states.state(RuleId(rule)).gone_since = Time(at);
    knowledge_.states.enter(RuleId(rule), RulePhase::kQuiet);
  }

  // Is the failure of `rule` acted on at that time?
  bool acts(const std::string& planner, std::size_t rule, Duration at) {
    knowledge_.now = Time(at);
    const auto made = make_planner(planner, Objective::kBalanced, scenario_);
    for (const Decision& decision : (*made)->plan(knowledge_.states.active(), knowledge_)) {
      if (decision.rule == RuleId(rule)) return decision.chosen.has_value();
    }
    return false;
  }

  RcaScenario scenario_ = pair();
  RuleSet rules_;
  Knowledge knowledge_;
};

TEST_F(TimingPlanners, ThePatientOneWaitsAsLongAsItIsTold) {
  fails(1, 10s);
  EXPECT_FALSE(acts("patient:2s", 1, 11900ms));
  EXPECT_TRUE(acts("patient:2s", 1, 12s));
  EXPECT_FALSE(acts("patient", 1, 13s));
  EXPECT_TRUE(acts("patient", 1, 13400ms)) << "3.4 s unless it is told";
}

TEST_F(TimingPlanners, ThePatientOneWaitsForWhatIsUpstream) {
  fails(1, 10s);
  fails(0, 11s);
  EXPECT_FALSE(acts("patient:2s", 1, 60s)) << "it is still failing";
  EXPECT_TRUE(acts("patient:2s", 0, 13s)) << "nothing is upstream of it";
  clears(0, 61s);
  EXPECT_FALSE(acts("patient:2s", 1, 62s));
  EXPECT_TRUE(acts("patient:2s", 1, 63s));
}

TEST_F(TimingPlanners, TheInformedOneWaitsUntilTheAlarmUpstreamWouldHaveCome) {
  fails(0, 10s);
  EXPECT_TRUE(acts("informed", 0, 10s));
  clears(0, 0s);
  fails(1, 10s);
  // Detected at 10 s, so it began at 9.8 s, and would show upstream at 11.8 s; 0.6 s for readings.
  EXPECT_FALSE(acts("informed", 1, 12300ms));
  EXPECT_TRUE(acts("informed", 1, 12400ms));
}

TEST_F(TimingPlanners, TheInformedOneWaitsUntilTheFailureIsNoEcho) {
  fails(1, 10s);
  fails(0, 12s);
  EXPECT_FALSE(acts("informed", 1, 20s));
  clears(0, 22s);
  // Recovered at 20 s; passed on within 1 s; shown 0.2 s later; 0.6 s for readings.
  EXPECT_FALSE(acts("informed", 1, 21700ms));
  EXPECT_TRUE(acts("informed", 1, 21800ms));
}

TEST_F(TimingPlanners, AreNamedWithTheirWait) {
  EXPECT_FALSE(complaint_about_planner("patient:500ms"));
  EXPECT_EQ(complaint_about_planner("patient:9s"),
            "the wait of planner 'patient:9s' is not from 500ms to 5s; write it as in patient:2s");
  EXPECT_TRUE(complaint_about_planner("patient:"));
  EXPECT_TRUE(complaint_about_planner("patients"));
  const auto usual = usual_planners();
  EXPECT_EQ(std::count(usual.begin(), usual.end(), "patient"), 0);
}

// Planners that wait for evidence blame no wrong component on usual robots.
TEST(TimingPlannersInEpisodes, AreRightWhereAlarmsOnlyComeLate) {
  RcaCampaign campaign;
  RcaSetting setting{20, 3, 0, false};
  setting.ignores_plumbing = true;
  setting.factors.detector_latency_s = {0, 1};
  setting.factors.states_latency = true;
  campaign.settings = {setting};
  campaign.planners = {"patient", "informed", "naive"};
  campaign.episodes = 40;
  const auto rows = run_campaign(campaign, 2, nullptr);
  ASSERT_TRUE(rows);
  EXPECT_GE(rows->at(0).exact.mean(), 0.9);
  EXPECT_GE(rows->at(1).exact.mean(), 0.9);
  EXPECT_LT(rows->at(2).exact.mean(), 0.3);
  EXPECT_EQ(rows->at(0).censored + rows->at(1).censored, 0);
}

}  // namespace
}  // namespace culprit::study::rca
