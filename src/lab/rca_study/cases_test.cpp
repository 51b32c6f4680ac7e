#include "rca_study/cases.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rca_study/generator.h"

namespace culprit::study::rca {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// c0 -> c1 -> c2, and c3 alone. Failures are passed on after 0.5 s.
RcaScenario chain(std::vector<InjectedFault> faults) {
  RcaScenario scenario;
  scenario.seed = 1;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "c" + std::to_string(i);
    scenario.components.push_back({name, Criticality::kError, {0.2}, {}});
    Treatment restart;
    restart.helps.fill(0.6);
    Treatment configure = restart;
    configure.repair = Repair::kConfigure;
    configure.helps.fill(0.4);
    scenario.components.back().treatments = {configure, restart};
    scenario.topics.push_back({"/" + name + "/out", {static_cast<std::size_t>(i)}, {}});
  }
  scenario.topics[0].subscribers = {{1, 1, 0.5}};
  scenario.topics[1].subscribers = {{2, 1, 0.5}};
  scenario.faults = std::move(faults);
  return scenario;
}

InjectedFault silent(std::size_t component) { return {component, FaultKind::kSilent, 3}; }

std::vector<std::size_t> ill_because(const CaseTruth& truth, std::size_t cause) {
  std::vector<std::size_t> all;
  for (const CaseEffect& effect : truth.effects) {
    if (std::find(effect.causes.begin(), effect.causes.end(), cause) != effect.causes.end())
      all.push_back(effect.component);
  }
  return all;
}

TEST(CaseTruth, HasTheEffectsOfEachFault) {
  const auto truth = truth_of(chain({silent(0)}));
  ASSERT_TRUE(truth);
  EXPECT_THAT(ill_because(*truth, 0), ElementsAre(1, 2));
  EXPECT_DOUBLE_EQ(truth->effects[1].since_s, 4);
  EXPECT_NEAR(truth->end_s, 9.2, 0.21);
  const auto both = truth_of(chain({silent(1), silent(0)}));
  ASSERT_TRUE(both);
  EXPECT_EQ(both->causes[0].fault.component, 0U);
  EXPECT_THAT(ill_because(*both, 0), ElementsAre(2));
  EXPECT_THAT(ill_because(*both, 1), ElementsAre(2));
}

TEST(CaseTruth, CountsARedundantInputOnlyTogetherWithTheOther) {
  RcaScenario redundant = chain({silent(0), silent(3)});
  redundant.topics[1].subscribers.clear();
  redundant.topics[0].subscribers = {{1, 1, 0.5, true}};
  redundant.topics[3].subscribers = {{1, 1, 0.5, true}};
  const auto truth = truth_of(redundant);
  ASSERT_TRUE(truth);
  EXPECT_THAT(ill_because(*truth, 0), ElementsAre(1));
  EXPECT_THAT(ill_because(*truth, 3), ElementsAre(1));
  redundant.faults.pop_back();
  EXPECT_FALSE(truth_of(redundant)) << "c3 is enough for c1";
}

TEST(CaseTruth, HasTheRepairsThatWorkMoreOftenThanNot) {
  RcaScenario scenario = chain({silent(0)});
  EXPECT_THAT(truth_of(scenario)->causes[0].repairs, ElementsAre(Repair::kRestart));
  scenario.faults[0].is_unfixable = true;
  EXPECT_THAT(truth_of(scenario)->causes[0].repairs, IsEmpty());
}

TEST(CaseTruth, NeedsAnEffectThatShows) {
  EXPECT_FALSE(truth_of(chain({silent(3)})));
  EXPECT_FALSE(truth_of(chain({silent(0), silent(3)})));
  RcaScenario unwatched = chain({silent(1)});
  unwatched.components[2].is_unwatched = true;
  EXPECT_FALSE(truth_of(unwatched));
  unwatched = chain({silent(1)});
  unwatched.components[1].is_unwatched = true;
  EXPECT_FALSE(truth_of(unwatched));
}

TEST(CaseTruth, DoesNotBlameAFaultForAnOutsideCause) {
  RcaScenario scenario = chain({silent(1)});
  scenario.common_causes.push_back({0, 3, 3, 10});
  const auto truth = truth_of(scenario);
  ASSERT_TRUE(truth);
  EXPECT_THAT(ill_because(*truth, 1), ElementsAre(2));
}

TEST(RcaCase, ShowsTheFailuresOfARobotThatNobodyRepairs) {
  const std::vector<std::string> none;
  const auto made = case_of(chain({silent(0)}), none);
  ASSERT_TRUE(made);
  const CaseCause& cause = made->truth.causes.front();
  EXPECT_GE(cause.fault.at_s, 8);
  EXPECT_NEAR(made->times_s.back(), made->truth.end_s, 1e-6);
  std::vector<std::size_t> ill;
  for (std::size_t place = 0; place < made->watched.size(); ++place) {
    if (made->readings.back()[place]) ill.push_back(made->watched[place]);
  }
  auto expected = ill_because(made->truth, cause.fault.component);
  expected.push_back(cause.fault.component);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(ill, expected);
  for (std::size_t t = 0; made->times_s[t] < cause.fault.at_s; ++t)
    EXPECT_THAT(made->readings[t], testing::Each(false));
}

TEST(RcaCase, HasTheExitsOfProcesses) {
  const std::vector<std::string> none;
  const auto made = case_of(chain({{0, FaultKind::kCrash, 3}}), none);
  ASSERT_TRUE(made);
  ASSERT_EQ(made->events.size(), 1U);
  EXPECT_EQ(made->events[0].kind, CaseEventKind::kExited);
  EXPECT_EQ(made->events[0].component, made->truth.causes[0].fault.component);
  EXPECT_NEAR(made->events[0].at_s, made->truth.causes[0].fault.at_s, 1e-6);
}

TEST(RcaCase, GivesItsComponentsAnOrderThatSaysNothing) {
  const std::vector<std::string> none;
  std::size_t first_faulty = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    RcaScenario scenario = chain({silent(0)});
    scenario.seed = seed;
    const auto made = case_of(scenario, none);
    first_faulty += made->truth.causes[0].fault.component == 0 ? 1 : 0;
  }
  EXPECT_GT(first_faulty, 2U);
  EXPECT_LT(first_faulty, 20U);
}

TEST(RcaCase, IsAdvisedOnWithoutAnyAction) {
  const std::vector<std::string> advisers = {"bayes", "paper", "informed"};
  const auto made = case_of(chain({silent(0)}), advisers);
  ASSERT_TRUE(made);
  const std::size_t cause = made->truth.causes[0].fault.component;
  for (const std::string& name : advisers) {
    const Advice& advice = made->advice.at(name);
    ASSERT_FALSE(advice.ranked.empty()) << name;
    EXPECT_EQ(advice.ranked[0], cause) << name;
    EXPECT_THAT(advice.causes, ElementsAre(cause)) << name;
    ASSERT_FALSE(advice.repairs.empty()) << name;
    EXPECT_EQ(advice.repairs[0].component, cause) << name;
    EXPECT_GT(advice.repairs[0].at_s, made->truth.causes[0].fault.at_s) << name;
  }
  EXPECT_EQ(made->advice.at("bayes").ranked.size(), 3U);
}

// The same chain, where nothing but a restart helps, which takes a component down.
RcaScenario restartable(std::vector<InjectedFault> faults) {
  RcaScenario scenario = chain(std::move(faults));
  for (RcaComponent& component : scenario.components)
    component.treatments.erase(component.treatments.begin());
  return scenario;
}

// bayes takes down no component before those upstream of it have answered.
TEST(RcaCase, PutsTheQuestionsOfAdvisersToTheRobot) {
  const std::vector<std::string> advisers = {"bayes"};
  const auto made = case_of(restartable({silent(1)}), advisers);
  ASSERT_TRUE(made);
  const std::size_t cause = made->truth.causes[0].fault.component;
  ASSERT_FALSE(made->events.empty());
  EXPECT_EQ(made->events[0].kind, CaseEventKind::kAnswered);
  EXPECT_TRUE(std::ranges::any_of(made->events, [&](const CaseEvent& event) {
    return event.component != cause;
  })) << "suppliers are asked, too";
  const auto& repairs = made->advice.at("bayes").repairs;
  ASSERT_FALSE(repairs.empty());
  EXPECT_EQ(repairs[0].component, cause);
  EXPECT_LT(repairs[0].at_s, made->truth.end_s - 1);
}

TEST(RcaCase, ShowsWhoDoesNotAnswer) {
  RcaScenario scenario = restartable({{0, FaultKind::kHang, 3}});
  scenario.components[0].detector.latency_s = 3;  // so that the failure of c1 is detected first
  const std::vector<std::string> advisers = {"bayes"};
  const auto made = case_of(std::move(scenario), advisers);
  ASSERT_TRUE(made);
  const std::size_t cause = made->truth.causes[0].fault.component;
  ASSERT_FALSE(made->events.empty());
  for (const CaseEvent& event : made->events)
    EXPECT_EQ(event.component == cause, event.kind == CaseEventKind::kUnanswered);
}

}  // namespace
}  // namespace culprit::study::rca
