#include "rca_study/factors.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rca_study/campaign.h"
#include "rca_study/rca_report.h"
#include "rca_study/rca_robot.h"
#include "rca_study/rules.h"
#include "rca_study/scenario_json.h"

namespace culprit::study::rca {
namespace {

using testing::HasSubstr;

// Every factor differs from the usual robots.
RcaFactors all_factors() { return {{0, 3}, true, 0.5, {1, 2}, 0.3, 0.1, 2, 12, 30}; }

RcaSetting with(RcaFactors factors) {
  RcaSetting setting{20, 3, 0, false};
  setting.factors = factors;
  return setting;
}

EpisodeResult played(const RcaScenario& scenario) {
  return play(scenario, std::move(*make_planner("naive", Objective::kBalanced, scenario)));
}

TEST(Factors, AreReadAsPeopleWriteThem) {
  EXPECT_EQ(*parse_range("0..3s"), (RangeOfSeconds{0, 3}));
  EXPECT_EQ(*parse_range("500ms..2s"), (RangeOfSeconds{0.5, 2}));
  EXPECT_EQ(*parse_range("0.1..0.8s"), (RangeOfSeconds{0.1, 0.8}));
  EXPECT_EQ(*parse_range("1s"), (RangeOfSeconds{1, 1}));
  EXPECT_DOUBLE_EQ(*parse_share("30%", 1), 0.3);
  EXPECT_DOUBLE_EQ(*parse_share("0.3", 1), 0.3);
}

TEST(Factors, AreRefusedWithWhatToWriteInstead) {
  EXPECT_EQ(parse_range("3..1s").error(),
            "'3..1s' ends before it begins; write the smaller value first, as in 1s..3s");
  EXPECT_EQ(parse_range("0..3").error(),
            "'0..3' is no range of time; write a range such as 0..3s or 200ms..1s");
  EXPECT_THAT(parse_range("0..3min").error(), HasSubstr("is not within 0..30s"));
  EXPECT_FALSE(parse_range(""));
  EXPECT_FALSE(parse_range(".."));
  EXPECT_FALSE(parse_range("-1s..1s"));
  EXPECT_EQ(parse_share("95%", 0.9).error(),
            "'95%' is out of range; write a share from 0 to 90%, such as 30% or 0.3");
  EXPECT_EQ(parse_share("many", 1).error(),
            "'many' is no share; write a share from 0 to 100%, such as 30% or 0.3");
  EXPECT_FALSE(parse_share("nan", 1));
}

TEST(Factors, AreRecordedWhereTheyAreChosen) {
  EXPECT_EQ(to_json(RcaFactors()), Json::object());
  const RcaFactors all = all_factors();
  EXPECT_EQ(*factors_from_json(to_json(all)), all);
  EXPECT_EQ(options_of(all),
            " --detector-latency 0..3s --stated --pass 50% --delay 1..2s --unwatched 30% --hidden "
            "10% --common-causes 2 --false-alarms 12 --faults-before 30");
  EXPECT_EQ(options_of({}) + describe({}), "");
  const auto refused = factors_from_json({{"hidden", 2}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "hidden is not between 0 and 1");
  RcaCampaign campaign;
  campaign.settings = {with(all)};
  campaign.planners = {"patient:2s", "informed"};
  campaign.episodes = 2;
  const auto rows = run_campaign(campaign, 2, nullptr);
  ASSERT_TRUE(rows);
  EXPECT_THAT(rca_table(campaign, *rows, Times::kLeftOut).caption,
              HasSubstr("detectors 0 to 3 s late, latencies stated in impacts"));
  EXPECT_THAT(rca_csv(*rows, Times::kLeftOut), HasSubstr(",--detector-latency 0..3s --stated"));
}

TEST(Factors, ChangeNothingElseOfARobot) {
  const RcaScenario usual = generate(with({}), 7);
  RcaFactors factors = all_factors();
  factors.states_latency = false;
  const RcaScenario other = generate(with(factors), 7);
  ASSERT_EQ(usual.topics.size(), other.topics.size());
  for (std::size_t t = 0; t < usual.topics.size(); ++t) {
    ASSERT_EQ(usual.topics[t].subscribers.size(), other.topics[t].subscribers.size());
    for (std::size_t s = 0; s < usual.topics[t].subscribers.size(); ++s)
      EXPECT_EQ(usual.topics[t].subscribers[s].component, other.topics[t].subscribers[s].component);
  }
  for (std::size_t f = 0; f < usual.faults.size(); ++f)
    EXPECT_EQ(usual.faults[f].component, other.faults[f].component);
}

TEST(Factors, SayHowManyOfARobotAreSo) {
  const RcaScenario scenario = generate(with(all_factors()), 7);
  int unwatched = 0;
  for (const RcaComponent& c : scenario.components) {
    unwatched += c.is_unwatched ? 1 : 0;
    EXPECT_LE(c.detector.latency_s, 3);
    EXPECT_EQ(c.detector.false_alarms_per_min, 12);
    const int needed = static_cast<int>(std::ceil(c.detector.latency_s / 0.2));
    EXPECT_EQ(c.treatments[0].impact, 2 + needed);
    EXPECT_EQ(c.treatments[2].impact, 15 + needed);
  }
  EXPECT_EQ(unwatched, 6);
  EXPECT_EQ(rules_of(scenario).rules.size(), 14u);
  EXPECT_EQ(rules_of(scenario).components.size(), 20u);
  long hidden = 0;
  long all = 0;
  for (const RcaTopic& topic : scenario.topics) {
    for (const Subscription& s : topic.subscribers) {
      if (s.passes <= 0) continue;
      ++all;
      hidden += s.is_hidden ? 1 : 0;
      EXPECT_EQ(s.passes, 0.5);
      EXPECT_GE(s.delay_s, 1);
    }
  }
  EXPECT_EQ(hidden, std::lround(0.1 * static_cast<double>(all)));
  EXPECT_EQ(scenario.common_causes.size(), 2u);
}

TEST(Factors, StandInTheScenarioFile) {
  const std::string text = to_json(generate(with(all_factors()), 7));
  const auto read = scenario_from_json(text);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(to_json(*read), text);
  RcaScenario same = generate(with(all_factors()), 7);
  same.common_causes[0].second = same.common_causes[0].first;
  EXPECT_EQ(scenario_from_json(to_json(same)).error(),
            "common_causes[0] is wrong: components does not name two different ones");
}

TEST(CommonCause, HitsTwoComponentsForAWhile) {
  RcaScenario scenario = generate({3, 1, 0, false}, 1);
  scenario.topics.clear();
  scenario.faults.clear();
  scenario.common_causes = {{0, 2, 1, 5}};
  Plant plant(scenario);
  const auto run = [&](double until_s) {
    while (plant.step(Time(from_seconds(until_s)))) continue;
  };
  EXPECT_FALSE(plant.is_well()) << "it is still to come";
  run(2);
  EXPECT_TRUE(plant.is_ill(0) && plant.is_ill(2));
  EXPECT_FALSE(plant.is_ill(1));
  EXPECT_FALSE(plant.fault(0)) << "the cause is in neither";
  plant.set_down(0, true);
  plant.repair(0);
  plant.set_down(0, false);
  EXPECT_TRUE(plant.is_ill(0)) << "no repair helps";
  run(9);
  EXPECT_TRUE(plant.is_well());
}

TEST(Unwatched, IsNeverAdaptedAndDoesNotCountInTheExactSet) {
  RcaScenario scenario = generate({3, 1, 0, false}, 1);
  scenario.topics = {{"/a", {0}, {{1, 1, 0.2, false}}}};
  scenario.components[0].is_unwatched = true;
  scenario.faults = {{0, FaultKind::kDegraded, 3}, {2, FaultKind::kHang, 3}};
  scenario.horizon_s = 30;
  for (RcaComponent& c : scenario.components) c.treatments[2].helps.fill(1);
  const EpisodeResult result = played(scenario);
  EXPECT_FALSE(result.is_exact) << "the consumer was adapted";
  EXPECT_GT(result.wrong_component, 0);
  EXPECT_EQ(result.unresolved, 1);
  scenario.topics.clear();
  EXPECT_TRUE(played(scenario).is_exact);
}

TEST(FalseAlarms, ComeAsOftenAsTheyAreSaidTo) {
  RcaScenario scenario = generate({2, 1, 0, false}, 1);
  scenario.topics.clear();
  scenario.faults = {{1, FaultKind::kHang, 3000}};
  scenario.horizon_s = 3600;
  scenario.components[0].detector.false_alarms_per_min = 6;
  const RuleSet rules = rules_of(scenario);
  RcaRobot robot(scenario, rules);
  std::vector<Observation> observations;
  while (robot.now() < Time(from_seconds(2900))) robot.observe(kNever, observations);
  int alarms = 0;
  bool was_ill = false;
  for (const Observation& observation : observations) {
    const auto* read = std::get_if<SignalRead>(&observation.what);
    if (read == nullptr) continue;
    const bool is_ill = read->value == Value(true);
    if (read->signal != SignalId(0)) {
      EXPECT_FALSE(is_ill);
      continue;
    }
    alarms += is_ill && !was_ill ? 1 : 0;
    was_ill = is_ill;
  }
  // A pause of 10 s and an alarm of 3 s, in the mean.
  EXPECT_NEAR(alarms, 2900 / 13, 45);
}

// Detectors that are up to 3 s late, which the rules do not state: it notices that from the way in which failures spread, and acts on the right components. Lessons from other faults help.
TEST(Factors, LatenciesThatNoRuleStatesAreFoundOut) {
  const auto exact = [](std::size_t faults_before) {
    RcaCampaign campaign;
    campaign.settings = {with({.detector_latency_s = {0, 3}, .faults_before = faults_before})};
    campaign.settings.front().ignores_plumbing = true;
    campaign.planners = {"bayes"};
    campaign.episodes = 30;
    return run_campaign(campaign, 2, {})->front().exact.mean();
  };
  EXPECT_GE(exact(0), 0.8);
  EXPECT_GE(exact(15), 0.9);
}

}  // namespace
}  // namespace culprit::study::rca
