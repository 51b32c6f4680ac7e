// The managers that the paper names beside those of the SUAVE study, on SUNSET.
#include "managers/style_planner.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"
#include "sunset_study/study.h"

namespace culprit::study {
namespace {

SunsetRun played(const char* planner, std::uint32_t run) {
  const auto study = SunsetStudy::make({{{}, planner, "live", Probabilities::kIdeal}}, 1);
  return study->play({0, run});
}

// A bandit is trained with it, so that several runs share one.
SunsetStudy study_of(const char* planner) {
  return std::move(*SunsetStudy::make({{{}, planner, "live", Probabilities::kIdeal}}, 1));
}

RuleSet rules_of(const char* planner) {
  return SunsetStudy::make({{{}, planner, "live", Probabilities::kIdeal}}, 1)->rules(0);
}

TEST(Styles, AreKnownByName) {
  for (const char* name : {"rebet", "ac-ros", "vogel", "ghahremani"})
    EXPECT_TRUE(find_style(name)) << name;
  EXPECT_FALSE(find_style("paper"));
}

TEST(Styles, RepairFailuresSideBySideAndWhatFollowsFromThemToo) {
  for (const char* planner : {"rebet", "ac-ros", "vogel", "ghahremani"}) {
    SCOPED_TRACE(planner);
    const RuleSet rules = rules_of(planner);
    std::size_t most = 0;
    for (std::uint32_t run = 0; run < 6; ++run) {
      std::set<RuleId> open;
      for (const Event& event : played(planner, run).events) {
        if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
          open.insert(rules[chosen->strategy].rule);
        if (const auto* failed = std::get_if<StrategyFailed>(&event.what))
          open.erase(rules[failed->strategy].rule);
        if (const auto* done = std::get_if<FailureResolved>(&event.what)) open.erase(done->rule);
        most = std::max(most, open.size());
      }
    }
    EXPECT_GE(most, 2u);
  }
}

// A restart that did not help is followed by a redeployment, but where each failure has one plan.
TEST(Styles, OfAcRosAndVogelHaveOnePlanForEachFailure) {
  for (const char* planner : {"rebet", "ac-ros", "vogel", "ghahremani"}) {
    const RuleSet rules = rules_of(planner);
    std::set<StrategyId> executed;
    for (std::uint32_t run = 0; run < 18; ++run) {
      for (const SunsetRun::Choice& choice : played(planner, run).choices)
        executed.insert(choice.strategy);
    }
    std::set<RuleId> repaired;
    for (const StrategyId id : executed) repaired.insert(rules[id].rule);
    if (std::string_view(planner) == "ac-ros" || std::string_view(planner) == "vogel") {
      EXPECT_EQ(executed.size(), repaired.size());
    } else {
      EXPECT_GT(executed.size(), repaired.size()) << planner;
    }
  }
}

// A loop of AC-ROS or mRUBiS (style_planner.h) plans for each failure, also if another explains it.
TEST(Styles, OfAcRosAndVogelHaveAPlanForEachFailureInOneLoop) {
  for (const Style style : {Style::kAcRos, Style::kVogel}) {
    plan::Scene scene(plan::failure_of("a", "A") + plan::failure_of("b", "B") +
                      plan::failure_of("c", "C"));
    scene.link("a", "b").fail("A").fail("B").fail("C");
    EXPECT_EQ(scene.plan(StylePlanner(style)), "A.redeploy B.redeploy C.redeploy");
  }
}

// A robot whose components a to d have failures of other levels, durations and numbers of connectors.
struct Issue {
  const char* component;
  const char* rule;
  double utility;  // level times connectors
  double cycles;
};
constexpr std::array<Issue, 4> kIssues = {
    {{"a", "A", 3 * 1, 2}, {"b", "B", 1 * 3, 9}, {"c", "C", 2 * 2, 3}, {"d", "D", 3 * 2, 20}}};

std::string rule_of(const Issue& issue, const char* level) {
  return fmt::format(
      "COMPONENT {0} NODE /{0} LAUNCH \"{0}\"\nRULE {1}\n  POLICIES {2}\n  TRIGGER x > 1\n"
      "    STRATEGY restart 90 10\n      ADAPTATION {0} restart {3}\n",
      issue.component, issue.rule, level, issue.cycles);
}

// Utility that is lost until all are repaired, one after the other.
double lost(const std::vector<std::size_t>& order) {
  double time = 0;
  double sum = 0;
  for (const std::size_t i : order) sum += kIssues[i].utility * (time += kIssues[i].cycles);
  return sum;
}

// Ghahremani et al. claim that their order is optimal in utility over time.
TEST(Styles, OfGhahremaniLosesTheLeastUtilityOverTimeOfAllOrders) {
  plan::Scene scene(rule_of(kIssues[0], "ERROR") + rule_of(kIssues[1], "NON_CRITICAL") +
                    rule_of(kIssues[2], "WARNING") + rule_of(kIssues[3], "ERROR"));
  scene.link("a", "b").link("b", "c").link("c", "d").link("b", "d");
  for (const Issue& issue : kIssues) scene.fail(issue.rule);
  scene.plan(StylePlanner(Style::kGhahremani));
  std::vector<std::size_t> chosen;
  for (const Decision& decision : scene.decisions()) chosen.push_back(decision.rule.index);
  ASSERT_EQ(chosen.size(), kIssues.size());
  std::vector<std::size_t> order(kIssues.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    EXPECT_LE(lost(chosen), lost(order) + 1e-9);
  } while (std::ranges::next_permutation(order).found);
}

// None of them asks which failure is an effect; only Random repairs one after the other.
TEST(Bandits, RepairEachFailureByItself) {
  for (const char* planner : {"rebet-ucb", "rebet-greedy", "rebet-random", "bandit", "random"}) {
    SCOPED_TRACE(planner);
    const SunsetStudy study = study_of(planner);
    const RuleSet& rules = study.rules(0);
    std::size_t most = 0;
    std::set<StrategyId> executed;
    for (std::uint32_t run = 0; run < 18; ++run) {
      std::set<RuleId> open;
      const SunsetRun story = study.play({0, run});
      for (const Event& event : story.events) {
        if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
          open.insert(rules[chosen->strategy].rule);
          executed.insert(chosen->strategy);
        }
        if (const auto* failed = std::get_if<StrategyFailed>(&event.what))
          open.erase(rules[failed->strategy].rule);
        if (const auto* done = std::get_if<FailureResolved>(&event.what)) open.erase(done->rule);
        most = std::max(most, open.size());
      }
    }
    if (std::string_view(planner) == "random") {
      EXPECT_EQ(most, 1u);
    } else {
      EXPECT_GE(most, 2u);
    }
    EXPECT_GE(executed.size(), 6u);
  }
}

// Redeploying always ends an outage, restarting does in half of the scenarios.
TEST(Bandits, PlayWhatHelpedInTheirTraining) {
  int redeployed = 0;
  int first = 0;
  const SunsetStudy study = study_of("bandit");
  const RuleSet& rules = study.rules(0);
  for (std::uint32_t run = 0; run < 36; ++run) {
    std::set<RuleId> seen;
    const SunsetRun story = study.play({0, run});
    for (const SunsetRun::Choice& choice : story.choices) {
      const Strategy& strategy = rules[choice.strategy];
      const bool is_outage =
          strategy.name.ends_with("restart") || strategy.name.ends_with("redeploy");
      if (!is_outage || !seen.insert(strategy.rule).second) continue;
      ++first;
      redeployed += strategy.name.ends_with("redeploy") ? 1 : 0;
    }
  }
  EXPECT_GT(redeployed, first * 3 / 4);
}

// A picture that is poor is not optimised while something is out.
TEST(Styles, VogelRepairsBeforeItOptimises) {
  const RuleSet rules = rules_of("vogel");
  for (std::uint32_t run = 0; run < 18; ++run) {
    std::set<RuleId> out;
    for (const Event& event : played("vogel", run).events) {
      if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
        if (rules[detected->rule].policies.criticality == Criticality::kError)
          out.insert(detected->rule);
      }
      if (const auto* done = std::get_if<FailureResolved>(&event.what)) out.erase(done->rule);
      const auto* chosen = std::get_if<StrategyChosen>(&event.what);
      if (chosen == nullptr) continue;
      const RuleId rule = rules[chosen->strategy].rule;
      EXPECT_TRUE(out.empty() || rules[rule].policies.criticality == Criticality::kError)
          << "run " << run << ": " << rules[chosen->strategy].name;
    }
  }
}

}  // namespace
}  // namespace culprit::study
