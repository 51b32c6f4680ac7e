#include "manager/held_back_reports.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr Time kHeldBack{100s};

struct Reported {
  // The reports about the one rule after so long, with such a reason against its strategy.
  std::size_t after(Duration time, Condition reason, Time failing_since = kHeldBack) {
    Decision decision;
    decision.rule = RuleId(std::size_t{0});
    Candidate candidate;
    candidate.strategy = StrategyId(std::size_t{0});
    candidate.excluded = reason;
    decision.candidates = {candidate};
    reports.held_back(decision, failing_since, kHeldBack + time, events);
    return events.size();
  }

  HeldBackReports reports{1};
  EventLog events;
};

TEST(HeldBackReports, TellAReasonOnce) {
  Reported r;
  EXPECT_EQ(r.after(0s, Condition::kWithheld), 1u);
  EXPECT_EQ(r.after(1h, Condition::kWithheld), 1u);
}

TEST(HeldBackReports, TellTwoReasonsThatHoldByTurnsOnceInAWhile) {
  Reported r;
  EXPECT_EQ(r.after(0s, Condition::kWithheld), 1u);
  EXPECT_EQ(r.after(1s, Condition::kSuspect), 2u);
  EXPECT_EQ(r.after(4999ms, Condition::kWithheld), 2u);
  EXPECT_EQ(r.after(5s, Condition::kWithheld), 3u);
}

TEST(HeldBackReports, BeginAnewWithTheFailure) {
  Reported r;
  EXPECT_EQ(r.after(0s, Condition::kWithheld), 1u);
  EXPECT_EQ(r.after(1s, Condition::kWithheld, kHeldBack + 1s), 2u);
}

TEST(HeldBackReports, BeginAnewOnceSomethingWasDone) {
  Reported r;
  EXPECT_EQ(r.after(0s, Condition::kWithheld), 1u);
  r.reports.went_on(RuleId(std::size_t{0}));
  EXPECT_EQ(r.after(1s, Condition::kWithheld), 2u);
}

}  // namespace
}  // namespace culprit
