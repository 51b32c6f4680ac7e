// The credit must not depend on the outcome: each case is asked of a strategy that helped and of
// one that did not.
#include "analyze/outcome_watch.h"

#include <gtest/gtest.h>

#include "knowledge/ambiguity.h"
#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr RuleId kWatchedCause{std::size_t{0}};
constexpr RuleId kWatchedEffect{std::size_t{1}};
constexpr RuleId kBeside{std::size_t{2}};

// b depends on a; the lamp stands beside them.
struct Judged {
  Judged(const std::string& criticality, bool has_helped)
      : rules(*check(Source("x.rules",
                            "COMPONENT a NODE /a\nCOMPONENT b NODE /b\n"
                            "COMPONENT lamp NODE /lamp\nDEPENDENCY b ON a\n"
                            "RULE Cause\nPOLICIES ERROR\nTRIGGER x > 1\n"
                            "STRATEGY s 90 10\nADAPTATION a restart 5\n"
                            "RULE Effect\nPOLICIES " +
                                criticality +
                                "\nTRIGGER y > 1\nSTRATEGY t 50 10\n"
                                "ADAPTATION b restart 5\n"
                                "RULE Dark\nPOLICIES ERROR\nTRIGGER z > 1\n"
                                "STRATEGY u 90 10\nADAPTATION lamp restart 5\n"))
                   .rules),
        helps(has_helped) {
    for (const char* node : {"/a", "/b", "/lamp"}) knowledge.graph.node_appeared(node);
    knowledge.outcomes.healthy = 10s;
    knowledge.states.state(kWatchedEffect).detection.trigger = Slot::of(!helps);
  }

  // At once if it helped, else at its deadline.
  void judge() {
    Attempt attempt;
    attempt.strategy = strategy(kWatchedEffect);
    attempt.first_change = attempt.effective = kBegun;
    attempt.deadline = kDeadline;
    watch.judged(attempt, helps, helps ? kBegun + 1s : kDeadline);
  }
  void fail(RuleId rule, Time at) {
    knowledge.states.enter(rule, RulePhase::kFailing);
    watch.detected(rule, at);
  }
  void adapt(RuleId rule, Time at) {
    void_verdicts_beside(knowledge, strategy(rule), at, knowledge.outcomes);
  }
  // Is it learned from once its time has come?
  bool counts() {
    watch.advance(kDeadline);
    watch.advance(kDue - 1ms);
    EXPECT_EQ(sum(), 10) << "not yet";
    watch.advance(kDue);
    return sum() > 10;
  }

  StrategyId strategy(RuleId rule) const { return rules[rule].strategies.front(); }
  double sum() const {
    const Belief belief = knowledge.beliefs[strategy(kWatchedEffect)];
    return belief.alpha + belief.beta;
  }

  static constexpr Time kBegun{100s};
  static constexpr Time kDeadline{105s};
  static constexpr Time kDue{115s};
  RuleSet rules;
  Knowledge knowledge{rules};
  OutcomeWatch watch{knowledge, {knowledge.beliefs, knowledge.outcomes, knowledge.events}};
  bool helps;
};

class OutcomeWatchOf : public testing::TestWithParam<bool> {};

TEST_P(OutcomeWatchOf, WhatStandsIsLearnedFrom) {
  Judged j("ERROR", GetParam());
  j.judge();
  j.fail(kBeside, Judged::kBegun + 7s);
  j.adapt(kBeside, Judged::kBegun + 2s);
  EXPECT_TRUE(j.counts());
}

TEST_P(OutcomeWatchOf, ASecondFaultUpstreamBlamesNobodyAndThanksNobody) {
  Judged j("ERROR", GetParam());
  j.judge();
  j.fail(kWatchedCause, Judged::kDeadline + 1s);
  EXPECT_FALSE(j.counts());
}

TEST_P(OutcomeWatchOf, WhatIsAdaptedUpstreamBeforeTheDeadlineMayHaveDoneIt) {
  Judged j("ERROR", GetParam());
  if (j.helps) {
    j.judge();
    j.adapt(kWatchedCause, Judged::kDeadline - 1s);
  } else {
    j.knowledge.states.state(kWatchedEffect).attempt.emplace().strategy =
        j.strategy(kWatchedEffect);
    j.knowledge.states.enter(kWatchedEffect, RulePhase::kAttempting);
    j.knowledge.states.state(kWatchedCause).attempt.emplace().strategy = j.strategy(kWatchedCause);
    Attempts attempts(j.knowledge.states);
    mark_ambiguous(j.knowledge, j.strategy(kWatchedCause), attempts, j.knowledge.outcomes);
    Attempt attempt = *j.knowledge.states[kWatchedEffect].attempt;
    attempt.first_change = attempt.effective = Judged::kBegun;
    attempt.deadline = Judged::kDeadline;
    j.watch.judged(attempt, false, Judged::kDeadline);
  }
  EXPECT_FALSE(j.counts());
}

TEST_P(OutcomeWatchOf, WhatIsAdaptedUpstreamAfterTheDeadlineHasNoPartInIt) {
  Judged j("ERROR", GetParam());
  j.judge();
  j.adapt(kWatchedCause, Judged::kDeadline);
  EXPECT_TRUE(j.counts());
}

TEST_P(OutcomeWatchOf, WhatHidItAndIsGoneBeforeTheDeadlineHidesItNoLonger) {
  Judged j("WARNING", GetParam());
  j.fail(kWatchedCause, Judged::kBegun - 1s);
  if (j.helps) j.judge();
  j.knowledge.states.enter(kWatchedCause, RulePhase::kQuiet);
  if (!j.helps) j.judge();
  EXPECT_TRUE(j.counts());
}

TEST_P(OutcomeWatchOf, NobodySeesThroughWhatIsMoreCriticalAtTheDeadline) {
  Judged j("WARNING", GetParam());
  j.fail(kWatchedCause, Judged::kBegun - 1s);
  j.judge();
  EXPECT_FALSE(j.counts());
}

INSTANTIATE_TEST_SUITE_P(AStrategyThat, OutcomeWatchOf, testing::Bool(),
                         [](const auto& each) { return each.param ? "Helped" : "DidNotHelp"; });

}  // namespace
}  // namespace culprit
