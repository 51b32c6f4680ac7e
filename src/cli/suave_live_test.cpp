// Culprit manages the live SUAVE: real processes, real DDS, twenty times as fast as real time.
#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "cli/console.h"
#include "cli/suave_demo.h"

namespace culprit::cli {
namespace {

bool has(const std::vector<std::string>& all, const std::string& wanted) {
  return std::find(all.begin(), all.end(), wanted) != all.end();
}

TEST(Suave, IsManagedThroughTheModesOfItsSystems) {
  std::ostringstream transcript;
  SuaveDemo::Options options;
  options.speed = 20;
  options.on_event = [&](const Event& event, const RuleSet& rules, Time start) {
    transcript << line(event, rules, start, Colour::kOff) << "\n";
  };
  const std::atomic<bool> stop = false;
  auto demo = SuaveDemo::start(std::move(options), stop);
  ASSERT_TRUE(demo) << demo.error();
  const auto outcome = (*demo)->fly();
  ASSERT_TRUE(outcome) << outcome.error() << "\n" << transcript.str();

  EXPECT_TRUE(outcome->mission.found_s) << transcript.str();
  EXPECT_GT(outcome->mission.inspected_m, 0) << transcript.str();
  // The search begins low in clear water; the thruster fails after 35 s.
  EXPECT_TRUE(has(outcome->failures, "SearchTooLow")) << transcript.str();
  EXPECT_TRUE(has(outcome->failures, "ThrusterFailed")) << transcript.str();
  EXPECT_GE(outcome->reaction_times.size(), 2u) << transcript.str();
  EXPECT_EQ(transcript.str().find("RIVAL"), std::string::npos) << transcript.str();
}

}  // namespace
}  // namespace culprit::cli
