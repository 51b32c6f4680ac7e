#include "analyze/due_verdicts.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using Verdict = DueVerdicts::Verdict;

constexpr RuleId kDueRule{std::size_t{0}};
constexpr RuleId kMoreCritical{std::size_t{1}};

// b depends on a. The strategy of a rule about b took effect; a more critical rule would adapt b, too.
struct Awaited {
  explicit Awaited(const std::string& policies = "", const std::string& adaptation = "restart")
      : rules(*check(Source("x.rules",
                            "CYCLE 200ms\nCOMPONENT a NODE /a LAUNCH \"a\"\n"
                            "COMPONENT b NODE /b LAUNCH \"b\"\nDEPENDENCY b ON a\n"
                            "SIGNAL x DIAGNOSTIC b KEY x\nSIGNAL y DIAGNOSTIC b KEY y\n"
                            "RULE Due\nPOLICIES WARNING " +
                                policies + "\nTRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION b " +
                                adaptation +
                                " 5\nRULE Worse\nPOLICIES ERROR\nTRIGGER y > 1\n"
                                "STRATEGY t 90 10\nADAPTATION b restart 5\n"))
                   .rules) {
    for (const char* node : {"/a", "/b"}) knowledge.graph.node_appeared(node);
    for (std::size_t i = 0; i < rules.inputs.size(); ++i)
      knowledge.signals.set_latency(InputId(i), kLatency);
    attempt.strategy = rules[kDueRule].strategies.front();
    attempt.stage = Attempt::Stage::kWaiting;
    attempt.first_change = attempt.effective = kEffective;
    attempt.deadline = verdicts.deadline(attempt);
    read(Slot::of(true), kEffective - 1s);
  }

  // The trigger has this value since then.
  void read(Slot trigger, Time since) {
    Detection& detection = knowledge.states.state(kDueRule).detection;
    detection.trigger = trigger;
    detection.trigger_since = since;
  }
  Verdict at(Time now) const { return verdicts.verdict(attempt, now); }

  static constexpr Time kEffective{100s};
  static constexpr Duration kLatency = 3s;
  RuleSet rules;
  Knowledge knowledge{rules};
  Detector detector{knowledge, knowledge.states};
  DueVerdicts verdicts{knowledge, detector};
  Attempt attempt;
};

TEST(DueVerdicts, FailAfterTheImpactAndTheLatencyOfWhatTheTriggerReads) {
  const Awaited w;
  const Time deadline = Awaited::kEffective + 5 * 200ms + Awaited::kLatency;
  EXPECT_EQ(w.attempt.deadline, deadline);
  EXPECT_EQ(w.at(deadline - 1ms), Verdict::kNotYet);
  EXPECT_EQ(w.at(deadline), Verdict::kFails);
  EXPECT_EQ(w.verdicts.next(w.attempt, Awaited::kEffective), deadline);
}

TEST(DueVerdicts, WaitForTheInputsOfWhatWasStartedButNotForEver) {
  Awaited w("", "redeploy");
  const ComponentId producer(std::size_t{0});
  w.knowledge.components[producer].alive = true;
  EXPECT_EQ(w.verdicts.deadline(w.attempt), Awaited::kEffective + 1s + Awaited::kLatency);
  w.knowledge.components[producer].alive = false;
  EXPECT_EQ(w.verdicts.deadline(w.attempt),
            Awaited::kEffective + DueVerdicts::kInputs + Awaited::kLatency);
}

TEST(DueVerdicts, SucceedOnceTheFailureHasClearedForACycle) {
  Awaited w;
  w.read(Slot::of(false), Awaited::kEffective + 500ms);
  EXPECT_EQ(w.at(Awaited::kEffective + 699ms), Verdict::kNotYet);
  EXPECT_EQ(w.at(Awaited::kEffective + 700ms), Verdict::kSucceeds);
}

TEST(DueVerdicts, DoNotFailWhatClearsAtTheDeadline) {
  Awaited w;
  w.read(Slot::of(false), w.attempt.deadline);
  EXPECT_EQ(w.at(w.attempt.deadline + 100ms), Verdict::kNotYet);
  EXPECT_EQ(w.at(w.attempt.deadline + 200ms), Verdict::kSucceeds);
}

TEST(DueVerdicts, WaitForATriggerThatIsUnknownButNotForEver) {
  Awaited w;
  w.read({}, Awaited::kEffective);
  const Time end = w.attempt.deadline + DueVerdicts::kLostAfter;
  EXPECT_EQ(w.at(end - 1ms), Verdict::kNotYet);
  EXPECT_EQ(w.at(end), Verdict::kFails);
  EXPECT_EQ(w.verdicts.next(w.attempt, w.attempt.deadline), w.attempt.deadline + 200ms)
      << "a more critical failure may come in each cycle";
}

TEST(DueVerdicts, HoldUpNoMoreCriticalFailureForATriggerThatIsUnknown) {
  Awaited w;
  w.read({}, Awaited::kEffective);
  w.knowledge.states.enter(kMoreCritical, RulePhase::kFailing);
  EXPECT_EQ(w.at(w.attempt.deadline), Verdict::kFails);
}

TEST(DueVerdicts, SucceedAtOnceWithOnChange) {
  const Awaited w("ON_CHANGE");
  EXPECT_EQ(w.at(Awaited::kEffective), Verdict::kSucceeds);
}

TEST(DueVerdicts, DoNotFailWhatIsSuspended) {
  Awaited w;
  w.attempt.stage = Attempt::Stage::kSuspended;
  EXPECT_EQ(w.at(w.attempt.deadline + 1h), Verdict::kNotYet);
  EXPECT_EQ(w.verdicts.next(w.attempt, w.attempt.deadline), w.attempt.deadline + 200ms);
}

TEST(DueVerdicts, ThankNobodyForWhatWentAwayBefore) {
  Awaited w;
  w.read(Slot::of(false), Awaited::kEffective - 1ms);
  EXPECT_TRUE(w.verdicts.went_away_before(w.attempt));
  w.read(Slot::of(false), Awaited::kEffective);
  EXPECT_FALSE(w.verdicts.went_away_before(w.attempt));
}

TEST(DueVerdicts, ExcuseAStartThatCannotHappen) {
  Awaited w("", "redeploy");
  const ComponentId started(std::size_t{1});
  w.attempt.obstacle = "its program is not there";
  EXPECT_EQ(w.verdicts.why_no_attempt(w.attempt), std::nullopt);
  w.knowledge.components[started].start_missing = "the program b";
  EXPECT_EQ(w.verdicts.why_no_attempt(w.attempt), "b cannot be started: the program b");
}

}  // namespace
}  // namespace culprit
