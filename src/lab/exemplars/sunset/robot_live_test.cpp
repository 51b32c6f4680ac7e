// The live robot keeps its promises: each fault shows as the failures that sunset_scenario.h says, the
// right adaptations end them, and the wrong ones do not.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "exemplars/sunset/experiment.h"
#include "exemplars/sunset/test_live_robot.h"

namespace culprit::sunset {
namespace {

using namespace std::chrono_literals;
using ros2::TransitionId;

// A robot that is up and well.
class SunsetRobot : public testing::Test, public LiveRobot {
 protected:
  void SetUp() override {
    ASSERT_TRUE(watcher().flows(topics::kSegmentation));
    ASSERT_TRUE(watcher().becomes_sure());
  }

  void break_with(std::string_view fault) {
    const Fault& f = *find_fault(fault);
    ASSERT_EQ(set(f.member, std::string(f.name), f.value), "");
  }
};

TEST_F(SunsetRobot, ComesUpByItself) {
  for (const Member member :
       {Member::kCamera, Member::kDepth, Member::kSensorFusion, Member::kSegmentation}) {
    EXPECT_TRUE(becomes(member, LifecycleState::kActive)) << name_of(member);
  }
  EXPECT_TRUE(becomes(Member::kImageEnhancement, LifecycleState::kInactive));
  EXPECT_FALSE(watcher().speaks_now(topics::kRgbEnhanced));
}

struct OutageCase {
  const char* fault;
  bool heals_by_restart;
};
void PrintTo(const OutageCase& c, std::ostream* out) { *out << c.fault; }

class SunsetOutage : public SunsetRobot, public testing::WithParamInterface<OutageCase> {};

std::string_view topic_of(Failure failure) {
  switch (failure) {
    case Failure::kCameraOutage:
      return topics::kRgbCamera;
    case Failure::kFusionOutage:
      return topics::kSensorsFused;
    default:
      return topics::kSegmentation;
  }
}

TEST_P(SunsetOutage, ShowsAsSilenceAndHealsByTheRightAdaptation) {
  const Fault& fault = *find_fault(GetParam().fault);
  const std::string_view topic = topic_of(fault.failures.front());

  break_with(fault.name);
  for (const Failure failure : fault.failures) {
    EXPECT_TRUE(watcher().falls_silent(topic_of(failure))) << topic_of(failure);
  }
  EXPECT_EQ(watcher().speaks_now(topics::kRgbCamera), topic != topics::kRgbCamera);
  EXPECT_EQ(watcher().speaks_now(topics::kSensorsFused), topic == topics::kSegmentation);

  EXPECT_EQ(restart(fault.member), "");
  EXPECT_EQ(watcher().speaks_now(topic), GetParam().heals_by_restart);

  break_with(fault.name);
  EXPECT_TRUE(watcher().falls_silent(topic));
  redeploy(fault.member);
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));
  EXPECT_TRUE(watcher().becomes_sure());
  EXPECT_EQ(get(fault.member, std::string(fault.name)), Value(false));
}

INSTANTIATE_TEST_SUITE_P(Faults, SunsetOutage,
                         testing::Values(OutageCase{"camera_driver_issue", true},
                                         OutageCase{"hardware_disconnect", false},
                                         OutageCase{"sync_issue", true},
                                         OutageCase{"memory_leakage", false},
                                         OutageCase{"cuda_out_of_memory", true},
                                         OutageCase{"gpu_failure", false}),
                         [](const auto& c) { return std::string(c.param.fault); });

TEST_F(SunsetRobot, DegradedPicturesAreHealedByTheEnhancementOnly) {
  break_with("image_degradation");
  EXPECT_TRUE(watcher().becomes_unsure());

  EXPECT_EQ(set(Member::kSensorFusion, "do_recalibration", true), "");
  EXPECT_TRUE(watcher().becomes_unsure());
  EXPECT_EQ(restart(Member::kCamera), "");
  EXPECT_TRUE(watcher().becomes_unsure());
  redeploy(Member::kCamera);
  EXPECT_TRUE(becomes(Member::kCamera, LifecycleState::kActive));
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));
  EXPECT_TRUE(watcher().becomes_unsure());

  EXPECT_EQ(change(Member::kImageEnhancement, TransitionId::kActivate), "");
  EXPECT_EQ(set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_enhanced")), "");
  EXPECT_TRUE(watcher().becomes_sure());
  EXPECT_TRUE(watcher().flows(topics::kRgbEnhanced));
}

TEST_F(SunsetRobot, AnEnhancementThatNobodyNeedsDoesHarmUntilItIsUndone) {
  EXPECT_EQ(change(Member::kImageEnhancement, TransitionId::kActivate), "");
  EXPECT_EQ(set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_enhanced")), "");
  EXPECT_TRUE(watcher().becomes_unsure());
  EXPECT_EQ(change(Member::kImageEnhancement, TransitionId::kDeactivate), "");
  EXPECT_EQ(set(Member::kSensorFusion, "topic_camera_input", std::string("rgb_camera")), "");
  EXPECT_TRUE(watcher().becomes_sure());
}

TEST_F(SunsetRobot, AShiftIsHealedByRecalibrationOnly) {
  break_with("image_shift");
  EXPECT_TRUE(watcher().becomes_unsure());

  EXPECT_EQ(restart(Member::kSensorFusion), "");
  EXPECT_TRUE(watcher().becomes_unsure());
  redeploy(Member::kSensorFusion);
  EXPECT_TRUE(becomes(Member::kSensorFusion, LifecycleState::kActive));
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));
  EXPECT_TRUE(watcher().becomes_unsure());
  EXPECT_EQ(get(Member::kSensorFusion, "image_shift"), Value(std::int64_t{300}));

  EXPECT_EQ(set(Member::kSensorFusion, "do_recalibration", true), "");
  EXPECT_TRUE(watcher().becomes_sure());
  EXPECT_EQ(get(Member::kSensorFusion, "image_shift"), Value(std::int64_t{0}));
  EXPECT_EQ(get(Member::kSensorFusion, "do_recalibration"), Value(false));
}

TEST_F(SunsetRobot, NoisyDepthShowsAsNoFailureAndStays) {
  break_with("depth_degradation");
  redeploy(Member::kDepth);
  EXPECT_TRUE(becomes(Member::kDepth, LifecycleState::kActive));
  EXPECT_TRUE(watcher().flows(topics::kSegmentation, 40));
  EXPECT_TRUE(watcher().becomes_sure());
  EXPECT_EQ(get(Member::kDepth, "depth_degradation"), Value(2.0));
}

TEST_F(SunsetRobot, ABlurIsSaidByTheCameraUntilItFocuses) {
  break_with("autofocus_needed");
  EXPECT_TRUE(watcher().says_autofocus("True"));
  EXPECT_TRUE(watcher().flows(topics::kRgbCamera)) << "pictures go on";
  EXPECT_EQ(restart(Member::kCamera), "");
  EXPECT_EQ(get(Member::kCamera, "autofocus_needed"), Value(true));

  EXPECT_EQ(set(Member::kCamera, "perform_autofocus", true), "");
  EXPECT_TRUE(watcher().says_autofocus("False"));
  EXPECT_EQ(get(Member::kCamera, "autofocus_needed"), Value(false));
  EXPECT_EQ(get(Member::kCamera, "perform_autofocus"), Value(false));
}

TEST_F(SunsetRobot, AShutdownTransitionEndsTheProcess) {
  EXPECT_EQ(change(Member::kDepth, TransitionId::kActiveShutdown), "");
  EXPECT_EQ(wait_for_end(Member::kDepth), 0);
  EXPECT_TRUE(watcher().falls_silent(topics::kSensorsFused));
  start(Member::kDepth);
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));
}

// Signals are blocked, to be read from a descriptor, as soon as main() has begun.
bool listens_for_signals(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigBlk:")) return line.find_first_of("123456789abcdef", 7) != line.npos;
  }
  return false;
}

TEST_F(SunsetRobot, EndsAtOnceWhenToldAlsoWhileItComesUp) {
  std::vector<Duration> times;
  const auto end_one = [&](Member member, int signal) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(WTERMSIG(end(member, signal)), 0) << name_of(member) << " was killed";
    times.push_back(std::chrono::steady_clock::now() - begin);
  };
  int signal = SIGINT;
  for (const Member member : kMembers) {
    end_one(member, signal);
    signal = signal == SIGINT ? SIGTERM : SIGINT;
  }
  const int pid = start(Member::kSegmentation);
  while (!listens_for_signals(pid)) std::this_thread::sleep_for(1ms);
  end_one(Member::kSegmentation, SIGTERM);  // while it comes up
  std::ranges::sort(times);
  EXPECT_LT(times[times.size() / 2], 1s) << "it waits for something else first";
}

TEST_F(SunsetRobot, IsBrokenAndClearedByTheExperimenter) {
  auto experiment = Experiment::start({kSpeed, state(), participant()});
  ASSERT_TRUE(experiment) << experiment.error();
  Experiment& e = **experiment;
  const auto becomes_well = [&e] {
    const auto until = std::chrono::steady_clock::now() + 30s;
    while (!e.measure().complaint.empty() && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(20ms);
    }
    return e.measure().complaint;
  };
  ASSERT_EQ(becomes_well(), "");
  e.restart_measuring();
  EXPECT_TRUE(watcher().flows(topics::kSegmentation, 40));
  const Measurements healthy = e.measure();
  EXPECT_GT(healthy.mean_iou.value_or(0), kGoodIou);
  EXPECT_GT(healthy.judged_frames, 5);

  for (const auto& [fault, outcome] : e.inject(*find_scenario("001"))) {
    EXPECT_TRUE(outcome) << fault->name << ": " << outcome.error();
  }
  EXPECT_TRUE(watcher().falls_silent(topics::kSegmentation));
  EXPECT_NE(e.measure().complaint, "");
  EXPECT_GT(e.measure().downtime_sec, 0);

  const auto cleared = e.clear();
  EXPECT_TRUE(cleared) << cleared.error();
  EXPECT_EQ(becomes_well(), "");
  const Measurements after = e.measure();
  EXPECT_GT(after.downtime_between_outputs_sec, 0);
  EXPECT_LE(after.downtime_between_outputs_sec, after.downtime_sec + 1e-9);

  end(Member::kCamera, SIGKILL);
  const auto refused = e.inject(*find_fault("camera_driver_issue"));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("/managed_subsystem/camera"), std::string::npos);
  EXPECT_FALSE(e.clear());
}

TEST_F(SunsetRobot, LosesProcessesToTheExperimenter) {
  auto experiment = Experiment::start({kSpeed, state(), participant()});
  ASSERT_TRUE(experiment) << experiment.error();
  Experiment& e = **experiment;
  EXPECT_TRUE(watcher().flows(topics::kRgbRaw)) << "meanwhile it sees the nodes";

  auto done = e.inject(ProcessFault::kStop, Member::kSegmentation);
  ASSERT_TRUE(done) << done.error();
  EXPECT_TRUE(watcher().falls_silent(topics::kSegmentation));
  EXPECT_TRUE(watcher().flows(topics::kSensorsFused, 40)) << "nobody waits for a stopped reader";
  done = e.clear();
  EXPECT_TRUE(done) << done.error();
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));

  done = e.inject(ProcessFault::kKill, Member::kDepth);
  ASSERT_TRUE(done) << done.error();
  EXPECT_EQ(wait_for_end(Member::kDepth), SIGKILL);
  EXPECT_TRUE(watcher().falls_silent(topics::kSegmentation));
  start(Member::kDepth);
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));

  done = e.inject(ProcessFault::kCrashAtStart, Member::kDepth);
  ASSERT_TRUE(done) << done.error();
  EXPECT_EQ(wait_for_end(Member::kDepth), SIGKILL);
  for (int crash = 0; crash < 2; ++crash) {
    start(Member::kDepth);
    const auto status = wait_for_end(Member::kDepth);
    ASSERT_TRUE(status);
    EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) != 0);
  }
  start(Member::kDepth);
  EXPECT_TRUE(watcher().flows(topics::kSegmentation));
}

}  // namespace
}  // namespace culprit::sunset
