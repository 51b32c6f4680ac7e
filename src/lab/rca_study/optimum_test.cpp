#include "rca_study/optimum.h"

#include <cmath>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "rca_study/episode.h"
#include "rca_study/generator.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

// One component whose kinds of faults all are helped as well: restart (half, 5 cycles) and redeploy
// (always, 10 cycles).
RcaScenario single() {
  RcaScenario scenario;
  scenario.components.push_back({"a", Criticality::kError, {}, {}});
  auto& treatments = scenario.components.front().treatments;
  treatments.push_back({Repair::kRestart, 50, 10, 5, 1, {}});
  treatments.push_back({Repair::kRedeploy, 99, 10, 10, 1, {}});
  treatments[0].helps.fill(0.5);
  treatments[1].helps.fill(1);
  scenario.faults = {{0, FaultKind::kSilent, 1}};
  return scenario;
}

double optimal_cost(const RcaScenario& scenario, Objective objective) {
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, objective);
  return Optimum(process).cost();
}

// By hand: w = balanced. A restart costs 0.5 * 5/10 + 0.25 + 0.1 = 0.6, a redeployment
// 0.5 + 0.25 + 0.5 + 0.1 = 1.35. One fault in seven is a crash, which only the latter helps.
TEST(Optimum, OfOneComponentIsWhatItIsByHand) {
  const double restart_first = 0.6 + 0.5 * 1.35;
  EXPECT_NEAR(optimal_cost(single(), Objective::kBalanced), 6.0 / 7 * restart_first + 1.35 / 7,
              1e-9);
  // A restart in vain costs as much as a redeployment: 1 + 0.01 each, and a little time.
  const double redeploy = 0.02 + 1 + 0.02 + 0.01;
  EXPECT_NEAR(optimal_cost(single(), Objective::kAdaptations), redeploy, 1e-9);
}

// A time in which nothing is worse than NON_CRITICAL costs a quarter of one with an ERROR.
TEST(Optimum, WeighsTimeByTheWorstFailure) {
  RcaScenario scenario = single();
  scenario.components[0].criticality = Criticality::kNonCritical;
  const double restart = 0.25 * 0.25 + 0.25 + 0.1;
  const double redeploy = 0.25 * 0.5 + 0.25 + 0.5 + 0.1;
  EXPECT_NEAR(optimal_cost(scenario, Objective::kBalanced),
              6.0 / 7 * (restart + 0.5 * redeploy) + redeploy / 7, 1e-9);
  // With an effect that is an ERROR the time costs as much as if it were the cause.
  scenario.components.push_back(scenario.components.front());
  scenario.components[1].name = "b";
  scenario.components[1].criticality = Criticality::kError;
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, Objective::kBalanced);
  const Round restart_first{{0, 0}};
  const auto cost = [&](Members ill) { return process.cost({ill, 0, {}, {}}, restart_first); };
  EXPECT_NEAR(cost(0b11) - cost(0b01), 0.75 * 0.25, 1e-9);
}

// Everything that may begin in everything that may be seen, and nothing is ever left out.
class Enumerated {
 public:
  explicit Enumerated(const RepairProcess& process) : process_(process) {}

  double cost() {
    double sum = 0;
    for (const auto& [probability, situation] : process_.beginnings())
      sum += probability * cost(situation);
    return sum;
  }

 private:
  // Weights in billionths; tries as one number each.
  using Key = std::tuple<Members, Members, std::vector<int>,
                         std::vector<std::tuple<Members, Members, std::int64_t>>>;

  double cost(const Situation& situation) {
    if (situation.ill == 0) return 0;
    Key key{situation.ill, situation.gone, {}, {}};
    for (const auto& tries : situation.tries)
      std::get<2>(key).push_back(8 * tries.turns + tries.tried);
    for (const auto& [faulty, passing, weight] : situation.belief)
      std::get<3>(key).emplace_back(faulty, passing, std::llround(1e9 * weight));
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
    double best = process_.cost_of_leaving_it_ill(situation);
    if (process_.is_open(situation)) {
      for (const Round& round : process_.rounds(situation)) {
        double sum = process_.cost(situation, round);
        for (const auto& [probability, next] : process_.outcomes(situation, round))
          sum += probability * cost(next);
        best = std::min(best, sum);
      }
    }
    return known_[key] = best;
  }

  const RepairProcess& process_;
  std::map<Key, double> known_;
};

// Where who has a fault stays in doubt (circles, several faults), and where it does not.
TEST(Optimum, IsTheLeastOfAllWhateverIsLeftOut) {
  for (const RcaSetting& setting :
       {RcaSetting{3, 2, 0, false}, RcaSetting{3, 2, 0, true}, RcaSetting{2, 2, 0, true},
        RcaSetting{3, 2, 0, true, true}, RcaSetting{3, 1, 0, false, true}}) {
    for (const std::uint64_t seed : {1u, 2u}) {
      const RcaScenario scenario = generate(setting, seed);
      const RuleSet rules = rules_of(scenario);
      for (const Objective objective : {Objective::kDowntime, Objective::kAdaptations}) {
        const RepairProcess process(scenario, rules, objective);
        EXPECT_NEAR(Optimum(process).cost(), Enumerated(process).cost(), 1e-9)
            << setting.components << " components, seed " << seed << ", " << to_string(objective);
      }
    }
  }
}

// a feeds b, surely. The ill components show which one is the cause, and a crash is visible.
TEST(Optimum, KnowsTheCauseFromItsEffects) {
  RcaScenario scenario = single();
  scenario.components.push_back(scenario.components.front());
  scenario.components.back().name = "b";
  scenario.topics = {{"/a", {0}, {{1, 1, 0.1, false}}}, {"/b", {1}, {}}};
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, Objective::kRedeployments);
  Optimum optimum(process);
  for (const auto& [probability, situation] : process.beginnings()) {
    EXPECT_DOUBLE_EQ(probability, situation.gone != 0 ? 1.0 / 14 : 6.0 / 14);
    const Round& round = optimum.round(situation);
    ASSERT_EQ(round.size(), 1u);
    EXPECT_EQ(round[0].component, (situation.ill & 1) != 0 ? 0u : 1u);
    EXPECT_EQ(round[0].treatment, situation.gone != 0 ? 1u : 0u);
  }
}

TEST(Optimum, HasBeliefsThatSumToOneWhateverHappens) {
  const RcaScenario scenario = generate({4, 2, 0, true}, 3);
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, Objective::kBalanced);
  double of_all = 0;
  for (const auto& [probability, situation] : process.beginnings()) {
    of_all += probability;
    for (const Round& round : process.rounds(situation)) {
      double sum = 0;
      for (const auto& outcome : process.outcomes(situation, round)) {
        sum += outcome.probability;
        double belief = 0;
        for (const auto& hypothesis : outcome.situation.belief) belief += hypothesis.weight;
        EXPECT_NEAR(belief, 1, 1e-9);
        EXPECT_EQ(outcome.situation.ill & ~situation.ill, 0u) << "nobody falls ill any more";
      }
      EXPECT_NEAR(sum, 1, 1e-9);
    }
  }
  EXPECT_NEAR(of_all, 1, 1e-9);
}

// Begins what the optimum does, and so costs as much; what never begins anything leaves all ill.
class Copy : public Planner {
 public:
  Copy(const RepairProcess& process, Optimum& optimum) : process_(process), optimum_(optimum) {}
  std::vector<Decision> plan(std::span<const RuleId>, const Knowledge& knowledge) const override {
    std::vector<Decision> decisions;
    for (const Treated& treated : optimum_.round(*process_.situation_of(knowledge))) {
      const RuleId rule(treated.component);
      decisions.push_back(
          {rule, knowledge.rules[rule].strategies[treated.treatment], false, {}, {}});
    }
    return decisions;
  }

 private:
  const RepairProcess& process_;
  Optimum& optimum_;
};

class Nothing : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId>, const Knowledge&) const override {
    return {};
  }
};

TEST(ExpectedCost, OfThePlannerThatDoesTheBestIsTheOptimum) {
  const RcaScenario scenario = single();
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, Objective::kBalanced);
  Optimum optimum(process);
  EXPECT_NEAR(expected_cost(process, rules, Copy(process, optimum)), optimum.cost(), 1e-9);
  EXPECT_NEAR(expected_cost(process, rules, Nothing()),
              process.cost_of_leaving_it_ill(process.beginnings().front().situation), 1e-9);
}

// In a circle of failures the rules do not say that feedback passes every second time, which the
// optimum knows: a planner can only guess who was first.
TEST(ExpectedCost, OfBayesIsHardlyAboveTheOptimum) {
  for (const bool is_cyclic : {false, true}) {
    for (const Objective objective : {Objective::kBalanced, Objective::kDowntime,
                                      Objective::kAdaptations, Objective::kRedeployments}) {
      double best = 0;
      double ours = 0;
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const RcaScenario scenario = generate({4, 1, 0, is_cyclic}, seed);
        const RuleSet rules = rules_of(scenario);
        const RepairProcess process(scenario, rules, objective);
        best += Optimum(process).cost();
        ours += expected_cost(process, rules, BayesPlanner(objective));
      }
      EXPECT_GE(ours, best - 1e-9) << to_string(objective);
      EXPECT_LE(ours, (is_cyclic ? 1.05 : 1.02) * best) << to_string(objective);
    }
  }
}

TEST(OptimumPlanner, RepairsASmallRobotOnTheManager) {
  const RcaScenario scenario = generate({4, 2, 0, true}, 3);
  const EpisodeResult result = play(scenario, optimum_planner(scenario, Objective::kBalanced));
  EXPECT_TRUE(result.is_recovered);
  EXPECT_EQ(result.unresolved, 0);
}

}  // namespace
}  // namespace culprit::study::rca
