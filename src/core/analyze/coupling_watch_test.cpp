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
  Two(const std::string& policies, Duration later, const std::string& level = "ERROR")
      : rules(*check(Source("x.rules",
                            "CYCLE 200ms\nCOMPONENT a NODE /a\nCOMPONENT b NODE /b\n"
                            "DEPENDENCY b ON a\nRULE Cause\nPOLICIES ERROR\n"
                            "TRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION a restart 5\n"
                            "RULE Effect\nPOLICIES " +
                                level + " " + policies +
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
    CouplingWatch(knowledge, {knowledge.states, knowledge.couplings, knowledge.latencies})
        .resolved(attempt, true, kResolved);
    const auto& settling = knowledge.states[kEffect].settling;
    return settling ? settling->since - kResolved : -1s;
  }

  // The same, but the cause cleared by itself, and something else had changed before the effect
  // came.
  Duration settles_after_clearing() {
    Attempt attempt;
    attempt.strategy = rules[kCause].strategies.front();
    attempt.first_change = attempt.effective = kCame + 1s;
    CouplingWatch watch(knowledge, {knowledge.states, knowledge.couplings, knowledge.latencies});
    watch.ended(attempt, kCame + 3s);
    watch.cleared(kCause, kCame + 4s);
    const auto& settling = knowledge.states[kEffect].settling;
    return settling ? settling->since - (kCame + 4s) : -1s;
  }

  // The inputs of the effect's rule may be five seconds old.
  void read_seldom(Duration latency = 5s) {
    for (const InputId id : rules[kEffect].inputs) knowledge.signals.set_latency(id, latency);
  }
  // A strategy of `rule` that began at `begin` and took effect a second later.
  Attempt attempt(RuleId rule, Time begin) const {
    Attempt attempt;
    attempt.strategy = rules[rule].strategies.front();
    attempt.first_change = begin;
    attempt.effective = begin + 1s;
    return attempt;
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

// The effect came 2 s after its cause; that was mended between 1 s and 3 s, so that it may take
// until 6 s to go.
TEST(CouplingWatch, TakesAnAttemptForAnEchoWhileTheEffectMayStillGoWithItsCause) {
  Two two("", 2s);
  two.read_seldom();
  CouplingWatch watch(two.knowledge,
                      {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
  watch.ended(two.attempt(kCause, Two::kCame + 1s), Two::kCame + 3s);
  EXPECT_TRUE(watch.is_echo(two.attempt(kEffect, Two::kCame + 5900ms)));
  EXPECT_FALSE(watch.is_echo(two.attempt(kEffect, Two::kCame + 6s)));
  EXPECT_FALSE(watch.is_echo(two.attempt(kCause, Two::kCame + 4s))) << "its own does not echo";
}

TEST(CouplingWatch, TakesNothingForAnEchoThatWasSeenOnlyAfterTheChange) {
  for (const Duration came : {4900ms, 5000ms}) {
    Two two("", came);
    two.read_seldom();
    CouplingWatch watch(two.knowledge,
                        {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
    watch.ended(two.attempt(kCause, Two::kCame - 1s), Two::kCame + 5s);
    EXPECT_EQ(watch.is_echo(two.attempt(kEffect, Two::kCame + 6s)), came < 5s);
  }
}

// It can only show that it is well once it is up again.
TEST(CouplingWatch, WaitsLongerForAnEffectThatWasItselfRestartedMeanwhile) {
  Two two("", 2s);
  two.read_seldom();
  CouplingWatch watch(two.knowledge,
                      {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
  watch.ended(two.attempt(kCause, Two::kCame + 1s), Two::kCame + 3s);
  watch.ended(two.attempt(kEffect, Two::kCame + 5s), Two::kCame + 7s);
  EXPECT_TRUE(watch.is_echo(two.attempt(kEffect, Two::kCame + 8900ms)));
  EXPECT_FALSE(watch.is_echo(two.attempt(kEffect, Two::kCame + 9s)));
  watch.ended(two.attempt(kEffect, Two::kCame + 9s), Two::kCame + 10s);
  EXPECT_FALSE(watch.is_echo(two.attempt(kEffect, Two::kCame + 10s))) << "that was too late";
}

// When an outage let a lesser failure through says nothing of how long that takes to go.
TEST(CouplingWatch, TakesWhatCameToLightWithTheRepairForNoLateEffect) {
  for (const char* level : {"WARNING", "ERROR"}) {
    Two two("", 4s, level);
    two.read_seldom();
    CouplingWatch watch(two.knowledge,
                        {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
    watch.ended(two.attempt(kCause, Two::kCame + 2s), Two::kCame + 5s);
    const bool is_lesser = std::string(level) == "WARNING";
    EXPECT_EQ(watch.is_echo(two.attempt(kEffect, Two::kCame + 8500ms)), !is_lesser);
    EXPECT_TRUE(watch.is_echo(two.attempt(kEffect, Two::kCame + 7900ms)))
        << "a reading from before may still be believed";
  }
}

// b's own repair resolves it just when a clears by itself: b did not bring a back, although a is
// reported to have cleared only after b's repair began.
TEST(CouplingWatch, DoesNotCoupleWhatWasGoneBeforeTheChange) {
  for (const bool was_gone : {true, false}) {
    Two two("", 1s);
    CouplingWatch watch(two.knowledge,
                        {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
    const Attempt attempt = two.attempt(kEffect, Two::kCame + 5s);
    Detection& detection = two.knowledge.states.state(kCause).detection;
    detection.trigger = Slot::of(false);
    detection.trigger_since = Two::kCame + 5s + (was_gone ? -10ms : 900ms);
    two.knowledge.states.enter(kCause, RulePhase::kQuiet);
    watch.cleared(kCause, Two::kCame + 6s);
    watch.resolved(attempt, true, Two::kCame + 7s);
    const auto& learned = two.knowledge.couplings.of(kCause);
    EXPECT_EQ(learned.empty(), was_gone);
  }
}

// The cause is there for half a minute, and the effect does not come: six times the usual delay.
TEST(CouplingWatch, CountsWhatStaysAwayWhileItsCauseIsThere) {
  for (const bool is_seen : {true, false}) {
    Two two("", 2s);
    RuleState& cause = two.knowledge.states.state(kCause);
    cause.onset = Onset{Two::kCame, Two::kCame};
    cause.detection.trigger = Slot::of(false);
    cause.detection.trigger_since = Two::kCame + 30s;
    two.knowledge.states.enter(kEffect, RulePhase::kQuiet);
    two.knowledge.states.state(kEffect).detection.trigger = Slot::of(false);
    for (const InputId id : two.rules[kEffect].inputs)
      two.knowledge.signals.set_read_at(id, Two::kCame + (is_seen ? 29s : 1s));
    CouplingWatch watch(two.knowledge,
                        {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
    watch.exposed_others(kCause, Two::kCame + 30s);
    EXPECT_EQ(two.knowledge.couplings.of(kCause, kEffect).spared, is_seen ? 6 : 0);
  }
}

// The consumer works again when its supplier does.
TEST(CouplingWatch, TakesAnEndOfTroubleUpstreamForAnAid) {
  for (const bool began_before : {true, false}) {
    Two two("", 0s);
    RuleState& effect = two.knowledge.states.state(kEffect);
    effect.onset = Onset{Two::kCame, Two::kCame};
    effect.detection.trigger = Slot::of(false);
    effect.detection.trigger_since = Two::kCame + 4s;
    const Time since = Two::kCame + (began_before ? -1s : 1s);
    two.knowledge.components[ComponentId(0u)].past_trouble = PastTrouble{since, Two::kCame + 4s};
    CouplingWatch watch(two.knowledge,
                        {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
    EXPECT_EQ(watch.is_unaided(kEffect), !began_before);
  }
}

// It has the usual time from the end of the change on: ten cycles.
TEST(CouplingWatch, GivesWhatCameToLightWithTheRepairTheUsualTimeToGo) {
  Two two("", 4s, "WARNING");
  two.read_seldom(2s);
  CouplingWatch watch(two.knowledge,
                      {two.knowledge.states, two.knowledge.couplings, two.knowledge.latencies});
  watch.ended(two.attempt(kCause, Two::kCame + 2s), Two::kCame + 5s);
  EXPECT_TRUE(watch.is_echo(two.attempt(kEffect, Two::kCame + 6900ms)));
  EXPECT_FALSE(watch.is_echo(two.attempt(kEffect, Two::kCame + 7100ms)));
}

}  // namespace
}  // namespace culprit
