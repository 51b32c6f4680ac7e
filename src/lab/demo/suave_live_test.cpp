// Culprit manages the live SUAVE: real processes, real DDS, twenty times as fast as real time.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/suave_demo.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

bool has(const std::vector<std::string>& all, const std::string& wanted) {
  return std::find(all.begin(), all.end(), wanted) != all.end();
}

// Kills the mode manager as soon as it is to change a mode for the first time.
class ModeManagerKiller {
 public:
  void on(const Event& event, const RuleSet& rules) {
    if (const auto* found = std::get_if<ComponentFound>(&event.what);
        found != nullptr && rules[found->component].name == "mode_manager" && pid_ == 0)
      pid_ = found->pid;
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    if (chosen == nullptr || pid_ == 0 || has_killed_) return;
    has_killed_ = ::kill(pid_, SIGKILL) == 0;
  }
  bool has_killed() const { return has_killed_; }

 private:
  pid_t pid_ = 0;
  std::atomic<bool> has_killed_ = false;
};

// The battery is charged on the way, and a mode manager that dies in the middle of a change is no
// obstacle.
TEST(Suave, IsManagedThroughTheModesOfItsSystems) {
  std::ostringstream transcript;
  ModeManagerKiller killer;
  SuaveDemo::Options options;
  options.is_extended = true;
  options.speed = 20;
  options.on_event = [&](const Event& event, const RuleSet& rules, Time start) {
    transcript << line(event, rules, start, Colour::kOff) << "\n";
    killer.on(event, rules);
  };
  const std::atomic<bool> stop = false;
  auto demo = SuaveDemo::start(std::move(options), stop);
  ASSERT_TRUE(demo) << demo.error();
  const auto outcome = (*demo)->fly();
  ASSERT_TRUE(outcome) << outcome.error() << "\n" << transcript.str();

  EXPECT_TRUE(killer.has_killed()) << transcript.str();
  EXPECT_THAT(transcript.str(), testing::HasSubstr("redeploy mode_manager: done"));
  EXPECT_TRUE(outcome->mission.found_s) << transcript.str();
  EXPECT_GT(outcome->mission.inspected_m, 0) << transcript.str();
  // The search begins low in clear water; the thruster fails after 35 s, the battery is low after
  // 150 s.
  for (const char* failure : {"SearchTooLow", "ThrusterFailed", "BatteryLow", "Recharged"})
    EXPECT_TRUE(has(outcome->failures, failure)) << failure << "\n" << transcript.str();
  EXPECT_GE(outcome->reaction_times.size(), 4u) << transcript.str();
  EXPECT_EQ(transcript.str().find("RIVAL"), std::string::npos) << transcript.str();
}

}  // namespace
}  // namespace culprit::lab
