// `culprit drill` on real processes: what it measures, and what a drill that is killed leaves behind.
#include <csignal>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "json/json.h"
#include "owners/proc.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kDrillRules = R"(
ROBOT two_sensors
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
COMPONENT depth  NODE /managed_subsystem/depth  LAUNCH "sunset-node depth"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 50 2
      ADAPTATION camera redeploy 5
)";

struct Drill : testing::Test {
  ~Drill() override {
    TestProgram end(world, {"culprit", "end-started"});
    end.wait();
  }
  std::vector<std::string> drill(std::vector<std::string> more) const {
    std::vector<std::string> all{"culprit",  "drill",    rules,
                                 "--launch", "--yes",    "--state-dir",
                                 state(),    "--record", (world.folder() / "record").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::string state() const { return (world.folder() / "state").string(); }
  bool has_record_of_injected() const {
    for (const auto& file : std::filesystem::directory_iterator(state()))
      if (file.path().extension() == ".drill") return true;
    return false;
  }

  TestWorld world;
  std::string rules = world.write("two.rules", kDrillRules);
};

TEST_F(Drill, MeasuresWhatTheRulesMakeOfEachFaultAndUndoesTheOthers) {
  const std::string page = (world.folder() / "drill.html").string();
  TestProgram program(world, drill({"--only", "camera", "--kinds", "kill,deactivate", "--hang",
                                    "0.5", "--html", page}));
  ASSERT_EQ(program.wait(120s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("kill camera: noticed after "));
  EXPECT_THAT(program.output(), HasSubstr("by CameraGone, helped by CameraGone.camera_redeploy"));
  EXPECT_THAT(program.output(), HasSubstr("deactivate camera: not noticed, undone after "));
  EXPECT_THAT(program.output(), HasSubstr("faults that no rule notices                deactivate"));
  EXPECT_TRUE(std::filesystem::exists(page));
  EXPECT_FALSE(has_record_of_injected());
  TestProgram resumed(world,
                      drill({"--only", "camera", "--kinds", "kill,deactivate", "--hang", "0.5"}));
  EXPECT_EQ(resumed.wait(60s), 0) << resumed.output();
  EXPECT_THAT(resumed.output(), testing::Not(HasSubstr("injects"))) << "all is done already";
  TestProgram replay(world, {"culprit", "replay", (world.folder() / "record/robot.journal")});
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(Drill, WithoutAYesInjectsNothing) {
  TestProgram program(world, {"culprit", "drill", rules, "--state-dir", state()});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.output(), HasSubstr("10 faults in random order"));
  EXPECT_THAT(program.output(), HasSubstr("nothing is injected: --yes agrees to the plan"));
}

TEST_F(Drill, ThatIsKilledLeavesNoProcessStoppedAndTheNextOneCanBegin) {
  TestProgram killed(world, drill({"--only", "depth", "--kinds", "hang", "--hang", "60"}));
  ASSERT_TRUE(killed.prints("injects hang depth", 60s)) << killed.output();
  std::this_thread::sleep_for(100ms);
  killed.signal(SIGKILL);
  killed.wait();
  EXPECT_TRUE(has_record_of_injected());
  const auto is_any_stopped = [] {
    for (const int pid : owners::all_processes())
      if (owners::has_variable(pid, "ROS_DOMAIN_ID=" + environment("ROS_DOMAIN_ID")) &&
          owners::state_letter(pid) == 'T')
        return true;
    return false;
  };
  for (const Time end = live_now() + 20s; is_any_stopped() && live_now() < end;)
    std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(is_any_stopped());
  TestProgram next(world, {"culprit", "drill", rules, "--launch", "--yes", "--state-dir", state(),
                           "--only", "camera", "--kinds", "kill"});
  EXPECT_EQ(next.wait(120s), 0) << next.output();
  EXPECT_FALSE(has_record_of_injected());
}

}  // namespace
}  // namespace culprit::cli
