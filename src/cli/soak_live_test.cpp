// One culprit heals the live SUNSET over and over. It must not hold more and more.
//
// CULPRIT_SOAK_SECONDS says how long (20 unless set; scripts/soak), CULPRIT_SOAK_SEED what is
// random.
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "demo/test_live_sunset.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

int setting(const char* name, int otherwise) {
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::atoi(value);
}

TEST(Soak, NothingLeaksWhileTheRobotIsBrokenAndHealed) {
  const auto length = std::chrono::seconds(setting("CULPRIT_SOAK_SECONDS", 20));
  std::mt19937 random(static_cast<std::mt19937::result_type>(setting("CULPRIT_SOAK_SEED", 1)));
  const TestWorld world;
  lab::LiveSunset robot(world);
  // So much is never broken in so short a time but here.
  TestProgram culprit(
      world, {"culprit", "run", "rules/sunset.rules", "--journal",
              (world.folder() / "sunset.journal").string(), "--settle", "2", "--intensity", "none",
              "--intensity-kind", "none", "--intensity-component", "none", "--restarts", "none",
              "--backoff", "0", "--healthy", "1"});
  ASSERT_TRUE(robot.is_well_within(30s)) << robot.complaint();

  Holdings early;
  Holdings now;
  int healed = 0;
  const Time begin = live_now();
  while (live_now() < later(begin, length)) {
    robot.break_something(random);
    ASSERT_TRUE(robot.is_well_within(90s)) << robot.complaint() << "\n" << culprit.output();
    ++healed;
    now = holdings_of(culprit.pid());
    if (live_now() < later(begin, length / 4) || healed == 1) early = now;
  }
  EXPECT_LE(now.descriptors, early.descriptors + 5);
  EXPECT_LE(now.kilobytes, early.kilobytes + early.kilobytes / 5);
  for (const sunset::Member member : sunset::kMembers) {
    // The robot is well without image_enhancement, which may have been told to crash at its starts.
    for (const Time end = live_now() + 60s; robot.processes(member).empty() && live_now() < end;)
      std::this_thread::sleep_for(50ms);
    EXPECT_EQ(robot.processes(member).size(), 1u) << name_of(member) << "\n" << culprit.output();
  }
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0) << culprit.output();
  std::cout << healed << " faults in " << seconds(live_now() - begin)
            << " s; culprit after a quarter: " << early.descriptors << " descriptors, "
            << early.kilobytes << " KiB; at the end: " << now.descriptors << ", " << now.kilobytes
            << " KiB\n";
}

}  // namespace
}  // namespace culprit::cli
