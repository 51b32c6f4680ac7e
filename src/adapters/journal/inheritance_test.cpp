// The inheritance that one culprit leaves to another one on another machine.
#include "journal/inheritance.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::journal {
namespace {

using namespace std::chrono_literals;

const RuleSet& heirs_rules() {
  static const RuleSet rules =
      *check(Source("t",
                    "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\n"
                    "ADAPTATION c restart 1\nSTRATEGY t 90 10\nADAPTATION c redeploy 1\n"))
           .rules;
  return rules;
}

Event then(Duration when, decltype(Event::what) what) { return {Time(when), std::move(what)}; }

constexpr std::size_t kMuch = 1 << 20;

Inheritance of_a_day() {
  const RuleId r(0);
  return {
      {{{"R", "s", {9, 2}, {5, 1}}},
       {{"R", "R", {3, 1, 2.5}}},
       {{"R", 2, 0.1, 2.5}},
       {{"Q", "R", 2}, {"R", "R", 3}}},
      {then(10s, FailureDetected{r, {}, {}}),
       then(11s, StrategyChosen{StrategyId(0), {}, {}, false, {}, {}}),
       then(12s, StrategyFailed{StrategyId(0), "it did not help"}), then(13s, RuleExhausted{r})}};
}

TEST(Inheritance, IsReadAsWrittenOnTheClockOfTheReader) {
  const std::string text = to_text(of_a_day(), heirs_rules(), kMuch);
  const auto told = inheritance_from_text(text, heirs_rules(), 100s, Time(1h));
  ASSERT_TRUE(told) << told.error();
  EXPECT_EQ(told->learned.beliefs, of_a_day().learned.beliefs);
  EXPECT_EQ(told->learned.couplings, of_a_day().learned.couplings);
  EXPECT_EQ(told->learned.latencies, of_a_day().learned.latencies);
  EXPECT_EQ(told->learned.coincidences, of_a_day().learned.coincidences);
  ASSERT_EQ(told->past.size(), 4u);
  EXPECT_EQ(told->past[0].at, Time(110s));
  EXPECT_TRUE(std::holds_alternative<FailureDetected>(told->past[0].what));
  EXPECT_EQ(std::get<StrategyChosen>(told->past[1].what).strategy, StrategyId(0));
  EXPECT_TRUE(std::holds_alternative<RuleExhausted>(told->past[3].what));
}

TEST(Inheritance, LeavesOutWhatBelongsToTheOtherMachine) {
  const Inheritance inheritance{
      {},
      {then(1s, ComponentFound{ComponentId(0), 4711}),
       then(2s, OutcomePending{StrategyId(0), true, Time(60s)}),
       then(3s, OrderAccepted{{1, "ann", "", Silence{RuleId(0), {}}}}),
       then(4s, OrderAccepted{{1, "ann", "", RunStrategy{StrategyId(1)}}})}};
  const auto told = inheritance_from_text(to_text(inheritance, heirs_rules(), kMuch), heirs_rules(),
                                          0s, Time(1h));
  ASSERT_TRUE(told) << told.error();
  ASSERT_EQ(told->past.size(), 1u);
  EXPECT_EQ(told->past[0].at, Time(4s));
}

TEST(Inheritance, NothingHappenedInTheFutureAndNoClockIsTooWrong) {
  const std::string text = to_text(of_a_day(), heirs_rules(), kMuch);
  const auto told = inheritance_from_text(text, heirs_rules(), 2h, Time(1h));
  ASSERT_TRUE(told);
  for (const Event& event : told->past) EXPECT_EQ(event.at, Time(1h));
  const auto wild = inheritance_from_text(text, heirs_rules(), Duration::max(), Time(1h));
  ASSERT_TRUE(wild);
  EXPECT_TRUE(wild->past.empty());
}

TEST(Inheritance, OfTooMuchTheNewestIsToldAndWhatWasLearnedLast) {
  Inheritance much = of_a_day();
  for (int i = 0; i < 1500; ++i)
    much.past.push_back(then(1s * (20 + i), StrategyChosen{StrategyId(1), {}, {}, false, {}, {}}));
  const auto all =
      inheritance_from_text(to_text(much, heirs_rules(), kMuch), heirs_rules(), 0s, Time(10h));
  ASSERT_TRUE(all);
  EXPECT_EQ(all->past.size(), Inheritance::kMostEvents);
  EXPECT_EQ(all->past.back().at, Time(1519s));
  const std::string little = to_text(much, heirs_rules(), 2000);
  EXPECT_LE(little.size(), 2000u);
  const auto some = inheritance_from_text(little, heirs_rules(), 0s, Time(10h));
  ASSERT_TRUE(some);
  EXPECT_EQ(some->learned.beliefs.size(), 1u);
  ASSERT_FALSE(some->past.empty());
  EXPECT_EQ(some->past.back().at, Time(1519s));
  EXPECT_EQ(to_text(much, heirs_rules(), 10), "");
}

// No event counts for longer than an hour, unless its failure has not cleared.
TEST(Inheritance, OfVeryManyEventsThoseThatDoNotCountAnyMoreAreForgotten) {
  Bequest bequest(heirs_rules());
  bequest.add(then(1s, FailureDetected{RuleId(0), {}, {}}));
  bequest.add(then(2s, RuleExhausted{RuleId(0)}));
  for (int i = 0; i < 2500; ++i)
    bequest.add(then(1min * i, AdaptationDone{StrategyId(0), 0, "as it was"}));
  const auto told =
      inheritance_from_text(bequest.text({}, kMuch), heirs_rules(), 0s, Time(5000min));
  ASSERT_TRUE(told) << told.error();
  EXPECT_LE(told->past.size(), Inheritance::kMostEvents);
  EXPECT_TRUE(std::holds_alternative<FailureDetected>(told->past[0].what));
  EXPECT_TRUE(std::holds_alternative<RuleExhausted>(told->past[1].what));
}

TEST(Inheritance, WhatIsDamagedOrOfAnotherVersionIsRefusedAndNeverHalfTaken) {
  const auto refused = [](const std::string& text) {
    return !inheritance_from_text(text, heirs_rules(), 0s, Time(1h)).has_value();
  };
  for (const char* text :
       {"", "null", "[]", "{}", "{\"version\":1}", "{\"version\":1,\"learned\":[],\"past\":[]}",
        "{\"version\":\"1\",\"learned\":{\"beliefs\":[],\"couplings\":[]},\"past\":[]}",
        "{\"version\":1,\"learned\":{\"beliefs\":[{\"rule\":\"R\",\"strategy\":\"s\",\"belief\":"
        "[-1,2],\"prior\":[1,1]}],\"couplings\":[]},\"past\":[]}"})
    EXPECT_TRUE(refused(text)) << text;
  std::string text = to_text(of_a_day(), heirs_rules(), kMuch);
  for (std::size_t cut = 0; cut + 1 < text.size(); cut += 7)
    EXPECT_TRUE(refused(text.substr(0, cut))) << cut;
  text.replace(text.find("\"version\":1"), 11, "\"version\":2");
  EXPECT_TRUE(refused(text));
}

TEST(Inheritance, WhatTheRulesHereDoNotHaveIsLeftOut) {
  const RuleSet other = *check(Source("o",
                                      "RULE Q\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\n"
                                      "ADAPTATION c restart 1\n"))
                             .rules;
  const auto told =
      inheritance_from_text(to_text(of_a_day(), heirs_rules(), kMuch), other, 0s, Time(1h));
  ASSERT_TRUE(told);
  EXPECT_TRUE(told->past.empty());
}

TEST(Inheritance, WhatIsKnownFromBothSidesCountsOnce) {
  const auto chosen = [](Duration at) {
    return then(at, StrategyChosen{StrategyId(0), {}, {}, false, {}, {}});
  };
  const History ours = {chosen(10s), chosen(60s)};
  // The first of ours as it came back; one that only they know, near to it; and one of theirs alone.
  const History theirs = {chosen(10s + 40ms), chosen(11s), chosen(100s)};
  const History all = joined(ours, theirs, heirs_rules());
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].at, Time(10s));
  EXPECT_EQ(all[1].at, Time(11s));
  EXPECT_EQ(all[2].at, Time(60s));
  EXPECT_EQ(all[3].at, Time(100s));
}

TEST(Inheritance, WhatTheyLearnedReplacesOursAndTheRestStays) {
  Learned ours{{{"R", "s", {2, 2}, {1, 1}}, {"R", "t", {4, 4}, {1, 1}}},
               {{"R", "Q", {1, 0}}},
               {{"P", 1, 3, 3}, {"R", 1, 2, 2}},
               {{"P", "Q", 5}, {"Q", "R", 1}}};
  inherit(ours, {{{"R", "s", {9, 2}, {5, 1}}, {"Q", "u", {1, 1}, {1, 1}}},
                 {{"R", "Q", {5, 1, 1.5}}},
                 {{"R", 4, 1, 2}},
                 {{"Q", "R", 3}, {"R", "R", 4}}});
  ASSERT_EQ(ours.beliefs.size(), 3u);
  EXPECT_EQ(ours.beliefs[0].belief.alpha, 9);
  EXPECT_EQ(ours.beliefs[1].belief.alpha, 4);
  ASSERT_EQ(ours.couplings.size(), 1u);
  EXPECT_EQ(ours.couplings[0].coupling, (Coupling{5, 1, 1.5}));
  EXPECT_EQ(ours.latencies, (std::vector<LearnedLatency>{{"P", 1, 3, 3}, {"R", 4, 1, 2}}));
  EXPECT_EQ(ours.coincidences,
            (std::vector<LearnedCoincidence>{{"P", "Q", 5}, {"Q", "R", 3}, {"R", "R", 4}}));
}

}  // namespace
}  // namespace culprit::journal
