// culprit and a healthy SUNSET beside programs that take all the processors: it adapts nothing, and a node that is killed
// meanwhile comes back.
//
// CULPRIT_HOG_SECONDS says how long each hog runs (scripts/healthy). Without it nothing is run: other tests would starve.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <sched.h>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/environment.h"
#include "demo/test_live_sunset.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

using Hogs = std::vector<std::unique_ptr<TestProgram>>;

std::chrono::seconds hog_time() {
  return std::chrono::seconds(std::atoi(environment("CULPRIT_HOG_SECONDS").c_str()));
}

class Hogged : public testing::Test {
 protected:
  void SetUp() override {
    if (hog_time() == 0s) GTEST_SKIP() << "CULPRIT_HOG_SECONDS is not set";
    robot = std::make_unique<lab::LiveSunset>(world);
    ASSERT_TRUE(robot->is_well_within(30s)) << robot->complaint();
  }

  TestProgram run() const {
    return TestProgram(world, {"culprit", "run", "rules/sunset.rules", "--settle", "2",
                               "--state-dir", (world.folder() / "state").string()});
  }
  // 25 for each processor.
  Hogs busy_programs() const {
    Hogs all;
    for (unsigned i = 0; i < 25 * std::thread::hardware_concurrency(); ++i)
      all.push_back(std::make_unique<TestProgram>(
          world, std::vector<std::string>{"sh", "-c", "while :; do :; done"}));
    return all;
  }
  // Of real-time priority: each takes 0.3 s of a processor, over and over. None where that is not allowed.
  Hogs real_time_programs() const {
    constexpr const char* kBusy =
        "import time\n"
        "while True:\n"
        "  end = time.monotonic() + 0.3\n"
        "  while time.monotonic() < end: pass\n"
        "  time.sleep(0.3)\n";
    Hogs all;
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
      auto each =
          std::make_unique<TestProgram>(world, std::vector<std::string>{"python3", "-c", kBusy});
      const sched_param priority{.sched_priority = 10};
      if (sched_setscheduler(each->pid(), SCHED_RR, &priority) != 0) return {};
      all.push_back(std::move(each));
    }
    return all;
  }
  void expect_no_action_while(const TestProgram& culprit) {
    const std::string before = culprit.output();
    std::this_thread::sleep_for(hog_time());
    const std::string said = culprit.output().substr(before.size());
    EXPECT_EQ(said.find(" decided "), std::string::npos) << said;
  }
  void expect_camera_back(const TestProgram& culprit) {
    ASSERT_TRUE(robot->inject("kill:camera"));
    EXPECT_TRUE(culprit.prints("redeploy camera: done", 60s)) << culprit.output();
    EXPECT_EQ(robot->processes(sunset::Member::kCamera).size(), 1u);
  }

  TestWorld world;
  std::unique_ptr<lab::LiveSunset> robot;
};

TEST_F(Hogged, AHealthyRobotIsLeftAloneAndAKilledNodeComesBack) {
  const TestProgram culprit = run();
  ASSERT_TRUE(culprit.prints("/managed_subsystem/sensors_fused")) << culprit.output();
  const Hogs hogs = busy_programs();
  expect_no_action_while(culprit);
  expect_camera_back(culprit);
}

TEST_F(Hogged, ByRealTimeProgramsAHealthyRobotIsLeftAlone) {
  const TestProgram culprit = run();
  ASSERT_TRUE(culprit.prints("/managed_subsystem/sensors_fused")) << culprit.output();
  const Hogs hogs = real_time_programs();
  if (hogs.empty()) GTEST_SKIP() << "no program may have real-time priority here";
  expect_no_action_while(culprit);
  expect_camera_back(culprit);
}

// As a freezer of the system does it, or a debugger.
TEST_F(Hogged, WhileItStandsStillItMissesAllAndJudgesNothingOfIt) {
  const TestProgram culprit = run();
  ASSERT_TRUE(culprit.prints("/managed_subsystem/sensors_fused")) << culprit.output();
  culprit.signal(SIGSTOP);
  std::this_thread::sleep_for(hog_time());
  culprit.signal(SIGCONT);
  expect_no_action_while(culprit);
  expect_camera_back(culprit);
}

}  // namespace
}  // namespace culprit::cli
