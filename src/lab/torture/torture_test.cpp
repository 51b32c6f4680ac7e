#include "torture/torture.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "torture/tortured_robot.h"

namespace culprit::torture {
namespace {

using namespace std::chrono_literals;

TEST(Torture, HundredsOfRobotsAreTreatedAsPromised) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const Scenario scenario = draw(seed);
    if (run(scenario).violation) ADD_FAILURE() << report(shrink(scenario));
  }
}

TEST(Torture, WhatWasOnceFoundStaysMended) {
  for (const std::uint64_t seed : {485u, 1293u, 1982u, 4047u, 4284u, 5524u, 13213u, 18280u, 28748u,
                                   62054u, 104963u, 121988u, 124431u})
    EXPECT_FALSE(run(draw(seed)).violation) << report(shrink(draw(seed)));
}

bool says(const RunOutcome& outcome, const std::string& what) {
  return std::any_of(outcome.timeline.begin(), outcome.timeline.end(),
                     [&](const std::string& line) { return line.find(what) != std::string::npos; });
}

// One part needs another that cannot be brought back. It waits for a person with that one, and culprit
// says so.
TEST(Torture, APartThatNeedsAnExhaustedOneIsExcused) {
  Scenario scenario;
  scenario.seed = 1;
  scenario.parts.resize(2);
  scenario.parts[1].needs = {0};
  scenario.governor.limits.restarts = {1, 1h};
  scenario.mishaps = {{Time(6s), Mishap::Kind::kKill, 0},
                      {Time(12s), Mishap::Kind::kKill, 0},
                      {Time(18s), Mishap::Kind::kBeyondRepair, 1}};
  const RunOutcome outcome = run(scenario);
  EXPECT_TRUE(says(outcome, "Silent0 is exhausted"));
  EXPECT_TRUE(says(outcome, "Silent1 waits: it depends on c0, which may be the cause (Silent0)"));
  EXPECT_FALSE(outcome.violation) << testing::PrintToString(outcome.timeline);
}

// As the supervisor does, before it reports the process.
TEST(TorturedRobot, ReportsInWhosePlaceAStartedProcessStands) {
  Scenario scenario;
  scenario.seed = 1;
  scenario.parts.resize(1);
  scenario.has_launcher = true;
  const RuleSet rules = *check(Source("torture.rules", rules_of(scenario))).rules;
  TorturedRobot robot(scenario, rules);
  const auto observed_until = [&](Time end) {
    std::vector<Observation> seen;
    while (robot.now() < end) robot.observe(end, seen);
    return seen;
  };
  observed_until(Time(2s));
  robot.befall({Time(2s), Mishap::Kind::kKill, 0});
  robot.execute({{1}, ComponentId(0), StartProcess{}, 1s, {}});
  const std::vector<Observation> seen = observed_until(Time(3s));
  const auto started = std::find_if(seen.begin(), seen.end(), [](const Observation& each) {
    return std::holds_alternative<StartedHere>(each.what);
  });
  ASSERT_NE(started, seen.end());
  ASSERT_NE(started + 1, seen.end());
  const auto& here = std::get<StartedHere>(started->what);
  EXPECT_EQ(here.launcher, 7000);
  const auto* process = std::get_if<ProcessSeen>(&(started + 1)->what);
  ASSERT_NE(process, nullptr);
  EXPECT_EQ(process->pid, here.pid);
}

TEST(Torture, TheSameSeedGivesTheSameRun) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_EQ(run(draw(seed)).timeline, run(draw(seed)).timeline) << seed;
}

TEST(Torture, MishapsLeaveTheirMark) {
  std::string all;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    for (const std::string& line : run(draw(seed)).timeline) all += line + "\n";
  }
  for (const char* part : {"is killed",
                           "everything is killed",
                           "is started again by its launcher",
                           "was never seen",
                           "is known to be down",
                           "a person ends the launch",
                           "is being ended",
                           "the manager crashes",
                           "is flapping: detected",
                           "culprit did not run for",
                           "resolved by",
                           "did not resolve",
                           "is held back",
                           "is exhausted",
                           "waits for approval",
                           "its last resort is due",
                           "is abandoned",
                           "is muted",
                           "INTERLOCK moving == false is false",
                           "was restarted a short while ago",
                           "and no more are allowed"})
    EXPECT_NE(all.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace culprit::torture
