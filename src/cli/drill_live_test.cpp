// `culprit drill` on real processes: what it measures, and what a drill that is killed leaves behind.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/text_file.h"
#include "drill/injected.h"
#include "owners/proc.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::string kDrillRules =
    "ROBOT two_sensors\n" + replaced_when_gone("camera", "ERROR", "50 2") +
    "COMPONENT depth NODE /managed_subsystem/depth LAUNCH \"sunset-node depth\"\n";

// The culprits that drills of this domain started; a killed drill leaves one behind.
std::vector<int> managers() {
  std::vector<int> found;
  for (const int pid : owners::all_processes()) {
    const auto words = read_text("/proc/" + std::to_string(pid) + "/cmdline");
    if (words && words->find(std::string("culprit\0run", 11)) != std::string::npos &&
        owners::has_variable(pid, "ROS_DOMAIN_ID=" + environment("ROS_DOMAIN_ID")))
      found.push_back(pid);
  }
  return found;
}

struct Drill : testing::Test {
  ~Drill() override {
    for (const int pid : managers()) kill(pid, SIGKILL);
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

// As with on_exit=Shutdown(): the drill itself is why the launch ends.
TEST_F(Drill, HealsALaunchThatEndsWithTheNodeThatItKilled) {
  const std::string node = (own_folder() / "sunset-node").string();
  const TestProgram launcher(world,
                             {"sh", "-c",
                              node + " camera & camera=$!; " + node +
                                  " depth & depth=$!; wait $camera; kill $depth; wait; exit 0"});
  TestProgram program(world, {"culprit", "drill", rules, "--yes", "--state-dir", state(), "--only",
                              "camera", "--kinds", "kill"});
  EXPECT_EQ(program.wait(120s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("kill camera: noticed after "));
}

TEST_F(Drill, WithoutAYesInjectsNothing) {
  TestProgram program(world, {"culprit", "drill", rules, "--state-dir", state()});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.output(), HasSubstr("10 faults in random order"));
  EXPECT_THAT(program.output(), HasSubstr("nothing is injected: --yes agrees to the plan"));
}

TEST_F(Drill, LeavesAloneAComponentWhoseProgramIsGone) {
  std::ofstream(rules, std::ios::app) << "COMPONENT lidar NODE /lidar LAUNCH \"no-such-program\"\n";
  TestProgram program(world,
                      {"culprit", "drill", rules, "--only", "lidar", "--state-dir", state()});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.output(), HasSubstr("lidar is left alone: its LAUNCH could not run: "));
  EXPECT_THAT(program.output(), HasSubstr("there is no fault to inject"));
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

TEST_F(Drill, ThatIsKilledWhileItsCulpritStartsLeavesNoneThatTheNextOneDoesNotKnow) {
  TestProgram killed(world, drill({"--only", "camera", "--kinds", "kill"}));
  const auto within = [](Duration time, const auto& holds) {
    for (const Time end = live_now() + time; !holds() && live_now() < end;)
      std::this_thread::sleep_for(2ms);
    return holds();
  };
  ASSERT_TRUE(within(20s, [] { return !managers().empty(); })) << killed.output();
  const int starting = managers().front();
  kill(starting, SIGSTOP);  // it does not answer yet
  EXPECT_TRUE(within(10s, [&] { return has_record_of_injected(); })) << killed.output();
  killed.signal(SIGKILL);
  killed.wait();
  kill(starting, SIGCONT);
  std::filesystem::remove_all(world.folder() / "record");
  TestProgram next(world, drill({"--only", "camera", "--kinds", "kill"}));
  EXPECT_EQ(next.wait(120s), 0) << next.output();
  EXPECT_FALSE(has_record_of_injected());
}

TEST_F(Drill, EndsWhenItsBudgetIsUsedUpThoughMoreFaultsWerePlanned) {
  TestProgram program(world, drill({"--only", "depth", "--kinds", "deactivate", "--hang", "0.5",
                                    "--times", "9", "--budget", "11"}));
  EXPECT_EQ(program.wait(90s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("7 more do not fit into the budget"));
  EXPECT_THAT(program.output(), HasSubstr("[1/2] deactivate depth: not noticed"));
  EXPECT_THAT(program.output(), HasSubstr("the budget is used up after 1 of 2"));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("[2/2]")));
}

TEST_F(Drill, AnAbortConditionThatIsTrueOrUnknownKeepsItFromInjecting) {
  std::ofstream(rules, std::ios::app) << "SIGNAL speed TOPIC /odom FIELD twist.twist.linear.x\n";
  for (const auto& [condition, why] :
       {std::pair("alive(depth)", "is true"), std::pair("speed > 0.5", "is unknown")}) {
    TestProgram program(world, drill({"--kinds", "kill", "--abort", condition}));
    EXPECT_EQ(program.wait(60s), 1) << program.output();
    EXPECT_THAT(program.output(),
                HasSubstr("ABORT " + std::string(condition) + " " + std::string(why)));
    EXPECT_THAT(program.output(), testing::Not(HasSubstr("injects")));
    EXPECT_FALSE(has_record_of_injected());
    std::filesystem::remove_all(world.folder() / "record");
  }
}

TEST_F(Drill, AnAbortConditionThatBecomesTrueUndoesTheFaultAndEndsTheDrill) {
  TestProgram program(world, drill({"--only", "depth", "--kinds", "deactivate", "--times", "3",
                                    "--abort", "lifecycle(depth) != \"active\""}));
  EXPECT_EQ(program.wait(90s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("[1/3] deactivate depth: proves nothing, ABORT "));
  EXPECT_THAT(program.output(), HasSubstr("the drill ends: ABORT lifecycle(depth) != "));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("[2/3]")));
  EXPECT_FALSE(has_record_of_injected());
  std::filesystem::remove_all(world.folder() / "record");
  TestProgram next(world, drill({"--only", "depth", "--kinds", "deactivate", "--hang", "0.5"}));
  EXPECT_EQ(next.wait(90s), 0) << next.output();
  EXPECT_THAT(next.output(), HasSubstr("deactivate depth: not noticed, undone after "))
      << "it was active again";
}

TEST_F(Drill, ThatOnlyWatchesProposesThresholds) {
  std::ofstream(rules, std::ios::app) << "RULE CameraSilent\n  POLICIES WARNING REPORT\n"
                                         "  TRIGGER age(/managed_subsystem/rgb_camera) > 900ms\n";
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram depth(world, {"sunset-node", "depth"});
  TestProgram program(world, {"culprit", "drill", rules, "--monitor", "4", "--state-dir", state()});
  EXPECT_EQ(program.wait(90s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("CameraSilent  age(/managed_subsystem/rgb_camera) > "));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("injects")));
  EXPECT_THAT(managers(), testing::IsEmpty());
}

TEST_F(Drill, ThatIsResumedMeasuresAllItsRuns) {
  std::ofstream(rules, std::ios::app) << "RULE CameraSilent\n  POLICIES WARNING REPORT\n"
                                         "  TRIGGER age(/managed_subsystem/rgb_camera) > 900ms\n";
  TestProgram pictured(world, {"sunset-node", "world"});
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram depth(world, {"sunset-node", "depth"});
  std::vector<int> values;
  for (int run = 1; run <= 2; ++run) {
    TestProgram program(
        world, {"culprit", "drill", rules, "--monitor", "4", "--json", "--state-dir", state(),
                "--record", (world.folder() / "record").string()});
    EXPECT_EQ(program.wait(90s), 0) << program.output();
    const std::string key = "\"values\":";
    const std::string output = program.output();
    const std::size_t at = output.find(key);
    ASSERT_NE(at, std::string::npos) << output;
    values.push_back(std::atoi(output.c_str() + at + key.size()));
  }
  EXPECT_GT(values[0], 0);
  EXPECT_GT(values[1], values[0] + values[0] / 2) << "both runs count";
}

TEST_F(Drill, ThatOnlyWatchesLeavesNoCulpritOnARobotThatIsIll) {
  TestProgram program(world, {"culprit", "drill", rules, "--monitor", "4", "--patience", "5",
                              "--state-dir", state()});
  EXPECT_EQ(program.wait(60s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("the robot is not healthy: "));
  EXPECT_THAT(managers(), testing::IsEmpty()) << "on a dry run it would heal nothing";
  EXPECT_FALSE(has_record_of_injected());
}

TEST_F(Drill, ARobotThatIsIllAlreadyIsNotBroken) {
  std::ofstream(rules, std::ios::app)
      << "RULE Ill\n  POLICIES WARNING REPORT\n  TRIGGER alive(camera)\n";
  TestProgram program(world, drill({"--kinds", "kill", "--patience", "5"}));
  EXPECT_EQ(program.wait(60s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("the robot is not healthy: Ill is "));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("injects")));
}

TEST_F(Drill, AParameterThatTheNodeDoesNotHaveProvesNothing) {
  std::ofstream(rules, std::ios::app) << "DRILL camera set_parameter expozure 0\n";
  TestProgram program(world, drill({"--kinds", "set_parameter"}));
  EXPECT_EQ(program.wait(60s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("set_parameter camera expozure 0: proves nothing, "
                                          "/managed_subsystem/camera has no parameter 'expozure'"));
}

TEST_F(Drill, InterruptedTwiceStillUndoesAndHeals) {
  TestProgram program(world, drill({"--only", "camera", "--kinds", "kill,hang", "--times", "9"}));
  ASSERT_TRUE(program.prints("injects", 60s)) << program.output();
  program.signal(SIGINT);
  std::this_thread::sleep_for(200ms);
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(60s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("the drill ends: interrupted"));
  EXPECT_FALSE(has_record_of_injected()) << "the robot was well at the end";
}

TEST_F(Drill, WhoseTerminalIsClosedUndoesAndHeals) {
  TestProgram program(world, drill({"--only", "camera", "--kinds", "deactivate", "--times", "9"}));
  ASSERT_TRUE(program.prints("injects", 60s)) << program.output();
  program.signal(SIGHUP);
  EXPECT_EQ(program.wait(60s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("the drill ends: interrupted"));
  EXPECT_FALSE(has_record_of_injected());
}

TEST_F(Drill, ASecondOneOfTheSameRobotLeavesTheFirstAlone) {
  TestProgram first(world, drill({"--only", "camera", "--kinds", "kill", "--times", "2"}));
  ASSERT_TRUE(first.prints("injects", 60s)) << first.output();
  TestProgram second(world, {"culprit", "drill", rules, "--yes", "--state-dir", state()});
  EXPECT_EQ(second.wait(), 1) << second.output();
  EXPECT_THAT(second.output(), HasSubstr("another drill of this robot runs"));
  EXPECT_THAT(second.output(), testing::Not(HasSubstr("injects")));
  EXPECT_EQ(first.wait(90s), 0) << first.output();
  EXPECT_THAT(first.output(), HasSubstr("[2/2] kill camera: noticed"));
}

TEST_F(Drill, WhoseCulpritWouldAskAPersonFirstInjectsNothing) {
  setenv("CULPRIT_APPROVE", "true", 1);
  TestProgram program(world, drill({}));
  EXPECT_EQ(program.wait(), 1) << program.output();
  unsetenv("CULPRIT_APPROVE");
  EXPECT_THAT(program.output(), HasSubstr("the options of culprit run have approve = true"));
  EXPECT_THAT(managers(), testing::IsEmpty());
}

TEST_F(Drill, AFaultThatIsLeftAndCannotBeUndoneKeepsItFromInjecting) {
  const auto path = std::filesystem::path(state()) /
                    (environment("ROS_DOMAIN_ID") + std::string("-two_sensors.drill"));
  std::filesystem::create_directories(path.parent_path());
  const drill::Injected left{{drill::FaultKind::kSetParameter, "camera", "exposure", Value(0.0)},
                             "/nowhere",
                             {},
                             Value(0.5)};
  ASSERT_TRUE(drill::write_injected(path, {"", {}, {left}}));
  TestProgram program(world, drill({"--kinds", "kill", "--patience", "8"}));
  EXPECT_EQ(program.wait(90s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("left by an earlier drill, and cannot be undone: "
                                          "set_parameter camera exposure 0"));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("injects")));
  const auto kept = drill::read_injected(path);
  ASSERT_TRUE(kept && *kept) << "the next drill tries again";
  EXPECT_EQ((*kept)->faults, std::vector{left});
}

TEST_F(Drill, AnAbortConditionThatTheFaultHidesEndsTheDrill) {
  std::string text = kDrillRules;
  const std::string_view policy = "POLICIES ERROR";
  text.insert(text.find(policy) + policy.size(),
              " FOR 20s");  // so that the camera hangs until the drill ends that
  std::ofstream(rules) << text
                       << "SIGNAL beat TOPIC /diagnostics FIELD header.stamp.sec FROM camera"
                          " STALE 1500ms\n";
  TestProgram program(
      world, drill({"--only", "camera", "--kinds", "hang", "--times", "3", "--abort", "beat < 0"}));
  EXPECT_EQ(program.wait(90s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("[1/3] hang camera: proves nothing, ABORT beat < 0"));
  EXPECT_THAT(program.output(), HasSubstr("is unknown"));
  EXPECT_THAT(program.output(), testing::Not(HasSubstr("[2/3]")));
  EXPECT_FALSE(has_record_of_injected());
}

TEST_F(Drill, EndsWhenCulpritIsPausedAndInjectsNothingMore) {
  TestProgram program(
      world, drill({"--only", "camera", "--kinds", "kill", "--times", "9", "--patience", "5"}));
  ASSERT_TRUE(program.prints("[1/9]", 60s)) << program.output();
  TestProgram pause(world, {"culprit", "pause", "--reason", "a test"});
  EXPECT_EQ(pause.wait(), 0) << pause.output();
  EXPECT_EQ(program.wait(60s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("culprit is paused"));
}

TEST_F(Drill, WhoseCulpritIsKilledStartsAnotherThatHeals) {
  TestProgram program(world, drill({"--only", "camera", "--kinds", "kill", "--times", "9"}));
  ASSERT_TRUE(program.prints("injects", 60s)) << program.output();
  for (const int pid : managers()) kill(pid, SIGKILL);
  EXPECT_EQ(program.wait(90s), 1) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("another one heals the robot"));
  EXPECT_FALSE(has_record_of_injected()) << program.output();
}

TEST_F(Drill, ThatStoodStillItselfGoesOnAndBlamesNobody) {
  TestProgram program(world, drill({"--only", "camera", "--kinds", "kill", "--times", "2"}));
  ASSERT_TRUE(program.prints("injects", 60s)) << program.output();
  program.signal(SIGSTOP);
  std::this_thread::sleep_for(5s);
  program.signal(SIGCONT);
  EXPECT_EQ(program.wait(60s), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("proves nothing, the drill itself stood still"));
  EXPECT_THAT(program.output(), HasSubstr("[2/2] kill camera: noticed"));
}

TEST_F(Drill, OfRulesThatCannotBeWrittenSaysSoBeforeIt) {
  chmod(rules.c_str(), 0400);
  // A superuser may write it without this capability, too.
  TestProgram program(world, {"setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override",
                              (own_folder() / "culprit").string(), "drill", rules, "--yes",
                              "--write", "--state-dir", state()});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.output(), HasSubstr("cannot be written: Permission denied"));
}

TEST_F(Drill, LosesDatagramsOfOneNodeAndLeavesNoRuleInTheFirewall) {
  if (std::system("nft list tables > /dev/null 2>&1") != 0) GTEST_SKIP() << "needs nft, as root";
  TestProgram program(world, drill({"--only", "camera", "--kinds", "loss", "--hang", "60"}));
  ASSERT_TRUE(program.prints("injects loss camera", 60s)) << program.output();
  const auto is_there = [] { return std::system("nft list tables | grep -q culprit_drill_") == 0; };
  for (const Time end = live_now() + 10s; !is_there() && live_now() < end;)
    std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(is_there());
  program.signal(SIGKILL);
  program.wait();
  for (const Time end = live_now() + 10s; is_there() && live_now() < end;)
    std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(is_there());
}

}  // namespace
}  // namespace culprit::cli
