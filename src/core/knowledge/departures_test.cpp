#include "knowledge/departures.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

// Three nodes of a launch that goes on.
struct ALaunchOfThree : testing::Test {
  using By = Departures::By;
  static constexpr int kLauncher = 50;
  static constexpr ComponentId kA{0}, kB{1}, kC{2};
  static Time at(Duration since) { return Time(since); }

  void SetUp() override {
    for (const ComponentId each : {kA, kB, kC}) arrives(each, 1s);
  }
  void arrives(ComponentId component, Duration when) {
    departures.arrived(component, ++pids, at(when), By::kOther);
    departures.launched(component, kLauncher);
  }
  void is_replaced(ComponentId component, Duration when) {
    departures.started_here({component, ++pids, kLauncher}, at(when));
    departures.arrived(component, pids, at(when), By::kCulprit);
  }
  // How long it is held back from then on.
  Duration held(ComponentId component, Duration when) const {
    const auto departure = departures.of(component, at(when));
    return departure ? departure->until - at(when) : Duration::zero();
  }

  RuleSet rules = *check(Source("test.rules",
                                "COMPONENT a LAUNCH \"a\"\nCOMPONENT b LAUNCH \"b\"\n"
                                "COMPONENT c LAUNCH \"c\"\n"))
                       .rules;
  Departures departures{rules};
  int pids = 100;
};

TEST_F(ALaunchOfThree, OneThatIsBackDoesNotLeaveTogetherWithALaterOne) {
  for (const bool is_by_culprit : {true, false}) {
    departures = Departures(rules);
    SetUp();
    departures.failed(kA, at(10s));
    is_by_culprit ? is_replaced(kA, 11s) : arrives(kA, 11s);
    departures.left(kB, at(15s));
    EXPECT_EQ(held(kB, 15s), Departures::kAlone) << is_by_culprit;
  }
}

TEST_F(ALaunchOfThree, OneThatIsNotBackLeavesTogetherWithALaterOne) {
  departures.failed(kA, at(10s));
  departures.left(kB, at(15s));
  EXPECT_EQ(held(kB, 15s), Departures::kTogether);
  is_replaced(kA, 16s);
  departures.left(kC, at(17s));
  EXPECT_EQ(held(kC, 17s), Departures::kTogether) << "as the one before it, which is away";
}

TEST_F(ALaunchOfThree, ThatAPersonEndsTakesAlongOneThatWasBack) {
  departures.left(kA, at(10s));
  is_replaced(kA, 12s);
  departures.left(kB, at(15s));
  departures.left(kC, at(16s));
  departures.launcher_ended({kA, kLauncher, true}, at(17s));
  const auto settled = departures.settle(at(17s));
  ASSERT_EQ(settled.down.size(), 1u);
  EXPECT_EQ(settled.down.front().components.size(), 3u);
  EXPECT_EQ(settled.down.front().why, StaysDown::Why::kPerson);
  EXPECT_EQ(departures.to_end(kA), pids);
}

}  // namespace
}  // namespace culprit
