// The managers that the paper names beside those of the SUAVE study, on SUNSET.
#include "managers/style_planner.h"

#include <set>

#include <gtest/gtest.h>

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

// A restart that did not help is followed by a redeployment, but of AC-ROS's one plan.
TEST(Styles, OnlyAcRosHasOnePlanForEachFailure) {
  for (const char* planner : {"rebet", "ac-ros", "vogel", "ghahremani"}) {
    const RuleSet rules = rules_of(planner);
    std::set<StrategyId> executed;
    for (std::uint32_t run = 0; run < 18; ++run) {
      for (const SunsetRun::Choice& choice : played(planner, run).choices)
        executed.insert(choice.strategy);
    }
    std::set<RuleId> repaired;
    for (const StrategyId id : executed) repaired.insert(rules[id].rule);
    if (std::string_view(planner) == "ac-ros") {
      EXPECT_EQ(executed.size(), repaired.size());
    } else {
      EXPECT_GT(executed.size(), repaired.size()) << planner;
    }
  }
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
