// Checks which events of earlier runs still count.
#include "journal/history.h"

#include <gtest/gtest.h>

#include "journal/event_json.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

using namespace std::chrono_literals;

RuleSet rules() {
  return *check(Source("t",
                       "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\n"
                       "ADAPTATION c restart 1\nSTRATEGY t 90 10\nADAPTATION c redeploy 1\n"))
              .rules;
}

Event at(Duration when, EventWhat what) { return {Time(when), std::move(what)}; }

template <class What>
std::size_t count(const History& past) {
  std::size_t found = 0;
  for (const Event& event : past) found += std::holds_alternative<What>(event.what) ? 1 : 0;
  return found;
}

TEST(History, AnOutcomeWaitsUntilItIsDueOrCounted) {
  const RuleSet r = rules();
  const StrategyId s(0);
  const History past = {at(1s, OutcomePending{s, true, Time(61s)})};
  EXPECT_EQ(count<OutcomePending>(still_counting(past, Time(60s), r)), 1u);
  EXPECT_EQ(count<OutcomePending>(still_counting(past, Time(61s), r)), 0u) << "nobody looked on";
  History counted = past;
  counted.push_back(at(30s, OutcomeCounted{s, OutcomeCounted::As::kNothing}));
  EXPECT_EQ(count<OutcomePending>(still_counting(counted, Time(60s), r)), 0u);
}

TEST(History, WhatAPersonEndedStaysDownUntilItIsBackOrAPersonOrdersSo) {
  const RuleSet r = *check(Source("t",
                                  "COMPONENT a NODE /a\nCOMPONENT b NODE /b\nRULE R\n"
                                  "POLICIES ERROR\nTRIGGER !alive(b)\nSTRATEGY s 90 10\n"
                                  "ADAPTATION b restart 1\n"))
                         .rules;
  const ComponentId a(0);
  const ComponentId b(1);
  History past = {at(1s, ComponentFound{a, 7}), at(2s, StaysDown{{a, b}, StaysDown::Why::kPerson})};
  const Time late(100h);
  const auto down = [&](const History& of) {
    std::size_t found = 0;
    for (const Event& event : of) {
      if (const auto* each = std::get_if<StaysDown>(&event.what)) found += each->components.size();
    }
    return found;
  };
  EXPECT_EQ(down(still_counting(past, late, r)), 2u);
  EXPECT_EQ(down(history_from_json(to_json(past, r), r)), 2u);
  past.push_back(at(3s, ComponentFound{a, 8}));
  EXPECT_EQ(down(still_counting(past, late, r)), 1u);
  History run = past;
  run.push_back(at(4s, OrderAccepted{{1, "ada", "", RunStrategy{StrategyId(0)}}}));
  EXPECT_EQ(down(still_counting(run, late, r)), 0u);
  past.push_back(at(4s, OrderAccepted{{1, "ada", "", Revive{}}}));
  EXPECT_EQ(down(still_counting(past, late, r)), 0u);
  past.push_back(at(5s, StaysDown{{b}, StaysDown::Why::kOrder}));
  EXPECT_EQ(down(still_counting(past, late, r)), 1u);
  // Each culprit discovers a node that was shut down, as it is.
  History shut = {at(1s, StaysDown{{a}, StaysDown::Why::kShutDown}), at(2s, ComponentFound{a, 7})};
  EXPECT_EQ(down(still_counting(shut, late, r)), 1u);
  shut.push_back(at(3s, LifecycleIntended{a, Lifecycle::kFinalized}));
  EXPECT_EQ(down(still_counting(shut, late, r)), 1u);
  shut.push_back(at(4s, LifecycleIntended{a, Lifecycle::kActive}));
  EXPECT_EQ(down(still_counting(shut, late, r)), 0u);
}

TEST(History, OutcomesAreReadBackAsTheyWereWritten) {
  const RuleSet r = rules();
  const History past = {
      at(1s, OutcomePending{StrategyId(1), true, Time(61s)}),
      at(2s, FailureResolved{RuleId(0), FailureResolved::How::kByStrategy, StrategyId(1), 1s})};
  const History again = history_from_json(to_json(past, r), r);
  ASSERT_EQ(again.size(), 2u);
  const auto& pending = std::get<OutcomePending>(again[0].what);
  EXPECT_EQ(pending.strategy, StrategyId(1));
  EXPECT_TRUE(pending.has_helped);
  EXPECT_EQ(pending.due, Time(61s));
  EXPECT_EQ(std::get<FailureResolved>(again[1].what).strategy, StrategyId(1));
}

TEST(History, OfEachComponentHowItCameUpLastIsReadBack) {
  const RuleSet r = rules();
  ASSERT_FALSE(r.components.empty());
  const ComponentId c(0);
  const ComingUp how{ComingUp::Driver::kOther, 300ms, 2500ms};
  const History past = {at(1s, CameUp{c, {ComingUp::Driver::kCulprit, 1s, 1s}}),
                        at(2s, CameUp{c, how})};
  const History kept = still_counting(past, Time(48h), r);
  ASSERT_EQ(kept.size(), 1u);
  const History again = history_from_json(to_json(kept, r), r);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(std::get<CameUp>(again[0].what).how, how);
}

// Journals of before outcomes waited.
TEST(History, OldRowsAreStillRead) {
  const RuleSet r = rules();
  const auto resolved = event_from_json(
      parse_json(R"({"type":"failure_resolved","rule":"R","reaction_s":1,"time":5})"), r);
  ASSERT_TRUE(resolved);
  EXPECT_FALSE(std::get<FailureResolved>(resolved->what).strategy);
}

TEST(History, WhatWasTriedCountsUntilTheFailureStayedAway) {
  const RuleSet r = rules();
  const History past = {at(1s, FailureDetected{RuleId(0)}),
                        at(2s, StrategyFailed{StrategyId(0), ""}),
                        at(3s, FailureResolved{RuleId(0), {}, {}, {}}),
                        at(5s, FailureDetected{RuleId(0)}),
                        at(6s, StrategyFailed{StrategyId(1), ""}),
                        at(7s, FailureResolved{RuleId(0), {}, {}, {}})};
  const History soon = still_counting(past, Time(10s), r);
  EXPECT_EQ(count<FailureDetected>(soon), 2u) << "it came back";
  EXPECT_EQ(count<StrategyFailed>(soon), 2u);
  EXPECT_EQ(count<StrategyFailed>(still_counting(past, Time(2h), r)), 0u);
}

}  // namespace
}  // namespace culprit::journal
