#include "analyze/coupling_watch.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr RuleId kCause{std::size_t{0}};
constexpr RuleId kEffect{std::size_t{1}};

// b depends on a; both fail, the effect so long after its cause.
struct Two {
  Two(const std::string& policies, Duration later)
      : rules(*check(Source("x.rules",
                            "CYCLE 200ms\nCOMPONENT a NODE /a\nCOMPONENT b NODE /b\n"
                            "DEPENDENCY b ON a\nRULE Cause\nPOLICIES ERROR\n"
                            "TRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION a restart 5\n"
                            "RULE Effect\nPOLICIES ERROR " +
                                policies +
                                "\nTRIGGER y > 1\nSTRATEGY t 90 10\n"
                                "ADAPTATION b restart 5\n"))
                   .rules) {
    for (const char* node : {"/a", "/b"}) knowledge.graph.node_appeared(node);
    fail(kCause, kCame);
    fail(kEffect, kCame + later);
  }

  void fail(RuleId rule, Time at) {
    knowledge.states.state(rule).failing_since = at;
    knowledge.states.enter(rule, RulePhase::kFailing);
  }
  // From when on a reading says whether the effect went away too.
  Duration settles_after() {
    Attempt attempt;
    attempt.strategy = rules[kCause].strategies.front();
    attempt.first_change = attempt.effective = kCame + 20s;
    CouplingWatch(knowledge).resolved(attempt, true, kResolved);
    const auto& settling = knowledge.states[kEffect].settling;
    return settling ? settling->since - kResolved : -1s;
  }

  // Likewise, where the cause went away by itself, and something else had changed before the effect
  // came.
  Duration settles_after_clearing() {
    Attempt attempt;
    attempt.strategy = rules[kCause].strategies.front();
    attempt.first_change = attempt.effective = kCame + 1s;
    CouplingWatch watch(knowledge);
    watch.ended(attempt, kCame + 3s);
    watch.cleared(kCause, kCame + 4s);
    const auto& settling = knowledge.states[kEffect].settling;
    return settling ? settling->since - (kCame + 4s) : -1s;
  }

  static constexpr Time kCame{100s};
  static constexpr Time kResolved{125s};
  RuleSet rules;
  Knowledge knowledge{rules};
};

TEST(CouplingWatch, GivesAnEffectAsLongToGoAsItTookToComeAndHalfAsLongAgain) {
  EXPECT_EQ(Two("", 2s).settles_after(), 3s);
  EXPECT_EQ(Two("", 0s).settles_after(), 0s) << "it came with its cause";
  EXPECT_EQ(Two("", 6s).settles_after(), 0s) << "so late it is no effect";
}

TEST(CouplingWatch, WaitsForTheWindowOfARuleThatCounts) {
  EXPECT_EQ(Two("HOLD 3/5", 2s).settles_after(), 4s);
  EXPECT_EQ(Two("HOLD 3/5", 0s).settles_after(), 1s);
}

TEST(CouplingWatch, TakesWhatCameSoonAfterItsCauseForOnItsWayWhateverHasChangedSince) {
  EXPECT_EQ(Two("", 1500ms).settles_after_clearing(), 2250ms);
  EXPECT_EQ(Two("", 2500ms).settles_after_clearing(), -1s) << "later than ten cycles";
  EXPECT_EQ(Two("HOLD 3/5", 2500ms).settles_after_clearing(), 4750ms) << "and its window";
}

}  // namespace
}  // namespace culprit
