// When a failure counts as gone: not at the first look that does not show it.
#include <gtest/gtest.h>

#include "analyze/analyzer.h"
#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

struct Watched {
  explicit Watched(const std::string& policies, const std::string& others = "")
      : rules(*check(Source("x.rules",
                            "CYCLE 200ms\nCOMPONENT c NODE /c LAUNCH \"c\"\n"
                            "SIGNAL x DIAGNOSTIC c KEY x\nRULE Bad\nPOLICIES ERROR " +
                                policies +
                                "\nTRIGGER x > 1\nSTRATEGY again 90 10\n"
                                "ADAPTATION c restart 5\n" +
                                others))
                   .rules) {}

  // x is `value` for `time`.
  void be(double value, Duration time) {
    knowledge.signals.set(InputId(0), Slot::of(value));
    for (const Time end = now + time; now < end; now += 50ms) analyzer.advance(now);
  }
  template <class What>
  int told() const {
    return static_cast<int>(
        std::count_if(knowledge.events.begin(), knowledge.events.end(),
                      [](const Event& event) { return std::holds_alternative<What>(event.what); }));
  }

  RuleSet rules;
  Knowledge knowledge{rules};
  Analyzer analyzer{knowledge,
                    {knowledge.states, knowledge.signals, knowledge.beliefs, knowledge.couplings,
                     knowledge.latencies, knowledge.coincidences, knowledge.transients,
                     knowledge.outcomes, knowledge.blindness, knowledge.events},
                    Time{},
                    Time{}};
  Time now{100s};
};

TEST(Clearing, TakesACycle) {
  Watched w("");
  w.be(2, 100ms);
  ASSERT_EQ(w.told<FailureDetected>(), 1);
  w.be(0, 200ms);
  EXPECT_EQ(w.told<FailureResolved>(), 0) << "it was false for less than a cycle";
  w.be(2, 100ms);
  w.be(0, 200ms);
  EXPECT_EQ(w.told<FailureResolved>(), 0) << "what flickers is not gone";
  w.be(0, 100ms);
  EXPECT_EQ(w.told<FailureResolved>(), 1);
  EXPECT_EQ(w.told<FailureDetected>(), 1);
}

TEST(Clearing, TakesAsLongAsDetecting) {
  Watched w("FOR 1s");
  w.be(2, 1100ms);
  ASSERT_EQ(w.told<FailureDetected>(), 1);
  w.be(0, 900ms);
  w.be(2, 50ms);
  w.be(0, 1s);
  EXPECT_EQ(w.told<FailureResolved>(), 0);
  w.be(0, 100ms);
  EXPECT_EQ(w.told<FailureResolved>(), 1);
}

TEST(Clearing, TakesSoManyCyclesThatTheRestOfTheWindowCannotHoldIt) {
  Watched w("HOLD 3/5");
  w.be(2, 1s);
  ASSERT_EQ(w.told<FailureDetected>(), 1);
  w.be(0, 600ms);
  EXPECT_EQ(w.told<FailureResolved>(), 0);
  w.be(0, 100ms);
  EXPECT_EQ(w.told<FailureResolved>(), 1);
}

TEST(Clearing, ByItselfIsLearnedOnceTheFailureStayedAwayForAsLongAsItWasThere) {
  Watched w("");
  w.be(2, 1s);
  w.be(0, 900ms);
  ASSERT_EQ(w.told<FailureResolved>(), 1);
  EXPECT_EQ(w.knowledge.transients.patience(RuleId(0u)), 0s);
  w.be(0, 200ms);
  EXPECT_EQ(w.knowledge.transients.longest(RuleId(0u)), 1s);
}

TEST(Clearing, OfAFailureThatComesAndGoesIsNoneByItself) {
  Watched w("");
  for (int i = 0; i < 5; ++i) {
    w.be(2, 1s);
    w.be(0, 500ms);
  }
  ASSERT_EQ(w.told<FailureResolved>(), 5);
  w.be(2, 50ms);
  EXPECT_EQ(w.knowledge.transients.seen(RuleId(0u)), (Transients::Seen{0, 5, {}}));
}

// Another failure begins while culprit is down: the next process detects both at once.
TEST(Detecting, AFailureThatAnEarlierProcessDetectedHasNotBegunTogetherWithANewOne) {
  for (const bool is_old : {false, true}) {
    Watched w("",
              "COMPONENT d NODE /d LAUNCH \"d\"\nSIGNAL y DIAGNOSTIC d KEY y\nRULE BadToo\n"
              "POLICIES ERROR\nTRIGGER y > 1\nSTRATEGY begin 90 10\nADAPTATION d restart 5\n");
    if (is_old) w.analyzer.remember({Event{Time(10s), FailureDetected{RuleId(0u)}}});
    for (const std::size_t input : {0u, 1u}) w.knowledge.signals.set(InputId(input), Slot::of(2.0));
    for (const Time end = w.now + 100ms; w.now < end; w.now += 50ms) w.analyzer.advance(w.now);
    ASSERT_EQ(w.told<FailureDetected>(), 2);
    EXPECT_EQ(w.knowledge.coincidences.together(RuleId(0u), RuleId(1u)), is_old ? 0 : 1);
  }
}

// However often what it reads changes: a window of five is five cycles.
TEST(Detecting, CountsAReadingForEachCycleWithHold) {
  Watched w("HOLD 3/5");
  for (const double value : {2, 3, 2, 3, 2, 3}) w.be(value, 50ms);
  EXPECT_EQ(w.told<FailureDetected>(), 0) << "two cycles";
  for (const double value : {2, 3, 2, 3}) w.be(value, 50ms);
  EXPECT_EQ(w.told<FailureDetected>(), 1);
}

}  // namespace
}  // namespace culprit
