// For tests: a camera whose failures culprit heals, and the culprit that is attacked meanwhile.
#pragma once

#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "exemplars/sunset/node_process.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {

class AttackedRobot : public testing::Test {
 public:
  static std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
    return count;
  }
  template <class Done>
  static bool eventually(Done done, Duration patience = TestProgram::kPatience) {
    for (const Time end = later(live_now(), patience); !done();) {
      if (live_now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }

 protected:
  static constexpr const char* kRules = R"(
ROBOT attacked
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/managed_subsystem/rgb_camera) > 5s
    STRATEGY camera_replace 90 10
      ADAPTATION camera redeploy 5
RULE CameraOff
  POLICIES ERROR
  TRIGGER lifecycle(camera) == "inactive" || lifecycle(camera) == "finalized"
    STRATEGY camera_again 90 10
      ADAPTATION camera redeploy 5
RULE CameraSick
  POLICIES ERROR
  TRIGGER level(camera) >= 2 || parameter(camera, image_degradation) > 0.5
    STRATEGY camera_anew 90 10
      ADAPTATION camera redeploy 5
)";

  ~AttackedRobot() override { kill_cameras(); }

  std::vector<int> cameras() const {
    return sunset::processes_of(sunset::Member::kCamera, ros2::options_from_environment()->domain);
  }
  // However they were started.
  void kill_cameras() const {
    for (const int pid : cameras()) kill(pid, SIGKILL);
  }
  TestProgram start_culprit(const std::vector<std::string>& more = {},
                            const char* rules = kRules) const {
    std::vector<std::string> all = {
        "culprit", "run",         world.write("attacked.rules", rules), "--settle",
        "1",       "--state-dir", (world.folder() / "state").string()};
    all.insert(all.end(), more.begin(), more.end());
    return TestProgram(world, std::move(all));
  }
  // The look before has a participant of its own, which is gone then.
  static bool has_looked(const TestProgram& culprit) {
    return culprit.prints("names, and the robot on domain");
  }
  // Kills the camera and waits until culprit has replaced it. Returns the time that it took.
  Duration expect_healed(const TestProgram& culprit) const {
    const std::size_t before = count_of(culprit.output(), "resolved by");
    kill_cameras();
    const Time broken = live_now();
    EXPECT_TRUE(eventually([&] { return count_of(culprit.output(), "resolved by") > before; }))
        << culprit.output();
    const Duration took = live_now() - broken;
    EXPECT_EQ(cameras().size(), 1u) << "resolved, and it is not there";
    return took;
  }

  TestWorld world;
};

}  // namespace culprit::cli
