#include "web/usage_history.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

constexpr const char* kUsedRules = R"(
COMPONENT camera NODE /camera
COMPONENT rover NODE /rover HOST user@rover2 UNIT rover.service
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

// A robot of which the kernel is asked as often as a test likes.
class UsedProcesses : public testing::Test {
 protected:
  UsedProcesses() { usage.begins(manager, {}, Time()); }

  void see(std::size_t component, ProcessState state, int pid) {
    std::vector<Observation> seen{{Time(), NodeAppeared{component == 0 ? "/camera" : "/rover"}},
                                  {Time(), ProcessSeen{ComponentId(component), state, pid, ""}}};
    const auto commands = manager.step(Time(), seen);
    usage.stepped({Time(), {}, seen, commands, manager.events()});
  }

  const RuleSet rules = *check(Source("test", kUsedRules)).rules;
  Manager manager{rules, std::make_unique<BayesPlanner>(), {}};
  std::map<int, ProcessStat> stats;
  UsageHistory usage{[this](int pid) -> std::optional<ProcessStat> {
    const auto found = stats.find(pid);
    if (found == stats.end()) return std::nullopt;
    return found->second;
  }};
};

TEST_F(UsedProcesses, AreMeasuredFromLookToLook) {
  usage.look(100);
  EXPECT_TRUE(usage.of("camera").empty()) << "its process is not known";
  see(0, ProcessState::kRunning, 12);
  stats[12] = {.processor = 1000ms, .threads = 1, .resident_bytes = 1000};
  usage.look(105);
  stats[12] = {.processor = 2500ms, .threads = 1, .resident_bytes = 3000};
  usage.look(110);
  ASSERT_EQ(usage.of("camera").size(), 1);
  EXPECT_EQ(usage.of("camera")[0].clock, 110);
  EXPECT_DOUBLE_EQ(usage.of("camera")[0].processor, 0.3);
  EXPECT_EQ(usage.of("camera")[0].memory, 3000);
  EXPECT_TRUE(usage.of("nobody").empty());
}

TEST_F(UsedProcesses, AreNotMixedUp) {
  see(0, ProcessState::kRunning, 12);
  stats[12] = {.processor = 50000ms, .threads = 1, .resident_bytes = 1000};
  stats[13] = {.processor = 60000ms, .threads = 1, .resident_bytes = 1000};
  usage.look(100);
  see(0, ProcessState::kRunning, 13);  // it was started anew
  usage.look(105);
  EXPECT_TRUE(usage.of("camera").empty()) << "nobody knows what 13 had used 5 s ago";
  stats[13].processor = 61000ms;
  usage.look(110);
  stats.erase(13);
  usage.look(115);
  ASSERT_EQ(usage.of("camera").size(), 1);
  EXPECT_DOUBLE_EQ(usage.of("camera")[0].processor, 0.2);
}

TEST_F(UsedProcesses, OfAnotherComputerAreNotThoseOfThisOne) {
  see(1, ProcessState::kRunning, 12);
  stats[12] = {.processor = 1000ms, .threads = 1, .resident_bytes = 1000};
  usage.look(100);
  usage.look(105);
  EXPECT_TRUE(usage.of("rover").empty());
}

TEST_F(UsedProcesses, AreKeptForAQuarterOfAnHourAndOverAReload) {
  see(0, ProcessState::kRunning, 12);
  stats[12] = {.processor = 1000ms, .threads = 1, .resident_bytes = 1000};
  for (int i = 0; i < 300; ++i) usage.look(100 + 5 * i);
  EXPECT_EQ(usage.of("camera").size(), UsageHistory::kMost);
  EXPECT_EQ(usage.of("camera").back().clock, 100 + 5 * 299);
  usage.begins(manager, {}, Time());
  EXPECT_EQ(usage.of("camera").size(), UsageHistory::kMost);
}

TEST_F(UsedProcesses, AreKeptForADayWithTheGreatestValuesOfEachMinute) {
  see(0, ProcessState::kRunning, 12);
  constexpr std::size_t kLooks = 2 * 86'400 / 5;
  double used = 0;
  for (std::size_t look = 0; look < kLooks; ++look) {
    const bool is_peak = look % 12 == 7;  // once a minute
    used += is_peak ? 4 : 1;
    stats[12] = {.processor = std::chrono::milliseconds(static_cast<int>(1000 * used)),
                 .threads = 1,
                 .resident_bytes = 1000};
    usage.look(100.0 + 5.0 * static_cast<double>(look));
  }
  const auto day = usage.day_of("camera");
  EXPECT_EQ(day.size(), UsageHistory::kMinutes + UsageHistory::kMost);
  EXPECT_NEAR(day.back().clock - day.front().clock, 86'400 + 900, 60);
  for (std::size_t i = 0; i < UsageHistory::kMinutes; ++i) EXPECT_NEAR(day[i].processor, 0.8, 1e-9);
  EXPECT_EQ(usage.of("camera").size(), UsageHistory::kMost);
}

TEST_F(UsedProcesses, MayStandWhereTheClockIsSetBack) {
  see(0, ProcessState::kRunning, 12);
  stats[12] = {.processor = 1000ms, .threads = 1, .resident_bytes = 1000};
  usage.look(100);
  usage.look(50);
  usage.look(50);
  for (const UsageHistory::Usage& look : usage.of("camera"))
    EXPECT_TRUE(std::isfinite(look.processor)) << look.clock;
}

}  // namespace
}  // namespace culprit::web
