// The journal as a user meets it: culprit killed in the middle of a repair, started again, asked
// what it did, and replayed.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

// The camera takes its time to come up, and culprit can be killed during the restart.
const std::string kJournalRules = "ROBOT one_camera\n" + replaced_when_gone("camera");

struct Journal : testing::Test {
  TestProgram culprit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "culprit");
    return TestProgram(world, std::move(arguments));
  }
  std::string said_by(std::vector<std::string> arguments, int code = 0) {
    TestProgram program = culprit(std::move(arguments));
    EXPECT_EQ(program.wait(), code) << program.output();
    return program.output();
  }

  TestWorld world;
  const std::string rules = world.write("one.rules", kJournalRules);
  const std::string state = (world.folder() / "state").string();
  const std::string journal = (world.folder() / "state" / "one_camera.journal").string();
};

int process_that_is_there(const std::string& output) {
  const std::string words = "camera is there (process ";
  return std::stoi(output.substr(output.rfind(words) + words.size()));
}

TEST_F(Journal, SurvivesAKillAndTellsAndReplaysWhatHappened) {
  TestProgram camera(world, {"sunset-node", "camera"});
  {
    TestProgram first = culprit({"run", rules, "--settle", "1", "--state-dir", state});
    ASSERT_TRUE(first.prints("camera is there")) << first.output();

    TestProgram second = culprit({"run", rules, "--state-dir", state});
    EXPECT_TRUE(second.prints("another culprit manages this robot")) << second.output();
    second.signal(SIGINT);
    EXPECT_EQ(second.wait(), 0);

    camera.signal(SIGKILL);
    camera.wait();
    ASSERT_TRUE(first.prints("CameraGone detected")) << first.output();
    ASSERT_TRUE(first.prints("camera is held responsible")) << first.output();
    first.signal(SIGKILL);
    EXPECT_EQ(first.wait(), -SIGKILL);
  }
  TestProgram second = culprit({"run", rules, "--settle", "3", "--state-dir", state});
  ASSERT_TRUE(second.prints("camera is there (process ")) << second.output();
  EXPECT_THAT(second.output(), HasSubstr("the last run ended"));
  second.signal(SIGINT);
  EXPECT_EQ(second.wait(), 0);
  kill(process_that_is_there(second.output()), SIGKILL);  // culprit leaves the robot running

  EXPECT_THAT(said_by({"log", "--all", "--journal", journal}),
              AllOf(HasSubstr("CameraGone detected"), HasSubstr("camera is to be active")));
  EXPECT_THAT(said_by({"log", "--journal", journal}),
              AllOf(HasSubstr("CameraGone detected"), testing::Not(HasSubstr("is to be active"))));
  const std::string why = said_by({"explain", "--last", "--journal", journal});
  EXPECT_THAT(why, HasSubstr("camera_redeploy"));
  EXPECT_THAT(why, HasSubstr("Strategies compared"));
  EXPECT_THAT(said_by({"audit", "verify", "--journal", journal}),
              HasSubstr("all as they were written"));
  EXPECT_THAT(said_by({"replay", journal}), HasSubstr("all decided as recorded"));
  EXPECT_THAT(said_by({"replay", journal, "--planner", "bayes"}), HasSubstr("lines differ"));
}

// In the middle of a repair, which goes on.
TEST_F(Journal, GoesOnWithRulesThatAreReloaded) {
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram run = culprit({"run", rules, "--settle", "2", "--state-dir", state});
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  world.write("one.rules", "RUEL Nothing\n");
  run.signal(SIGHUP);
  ASSERT_TRUE(run.prints("the rules are not reloaded")) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("did you mean RULE?"));

  world.write("one.rules", kJournalRules + R"(
RULE CameraStopped
  POLICIES WARNING
  TRIGGER age(/managed_subsystem/rgb_camera) > 1h
    STRATEGY camera_restart 90 10
      ADAPTATION camera restart 5
)");
  camera.signal(SIGKILL);
  camera.wait();
  ASSERT_TRUE(run.prints("camera is held responsible")) << run.output();
  run.signal(SIGHUP);
  ASSERT_TRUE(run.prints("is reloaded, with 2 rules")) << run.output();
  ASSERT_TRUE(run.prints("camera_redeploy for CameraGone was under way")) << run.output();
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 0);
  kill(process_that_is_there(run.output()), SIGKILL);
  EXPECT_THAT(said_by({"log", "--journal", journal}), HasSubstr("one.rules, reloaded by SIGHUP"));
  EXPECT_THAT(said_by({"replay", journal}), HasSubstr("all decided as recorded"));
  EXPECT_THAT(said_by({"replay", journal, "--session", "1"}), HasSubstr("all decided as recorded"));
  EXPECT_THAT(said_by({"audit", "verify", "--journal", journal}),
              HasSubstr("all as they were written"));
}

TEST_F(Journal, ThatCannotBeWrittenKeepsNobodyFromManaging) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram run = culprit({"run", rules, "--journal", "/proc/nowhere/a.journal"});
  ASSERT_TRUE(run.prints("cannot write the journal '/proc/nowhere/a.journal'")) << run.output();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 0);
  EXPECT_THAT(run.output(), HasSubstr("are lost"));
  EXPECT_THAT(run.output(), HasSubstr("there is no folder '/proc/nowhere' yet"));
}

TEST_F(Journal, BeliefsGoFromRobotToRobot) {
  const std::string file = (world.folder() / "beliefs.json").string();
  world.write("beliefs.json", R"({"format": "culprit-beliefs", "format_version": 1,
    "beliefs": [{"rule": "CameraGone", "strategy": "camera_redeploy",
                 "belief": [12, 1], "prior": [9, 1]}], "couplings": [],
    "latencies": [{"rule": "CameraGone", "count": 2, "least_s": 0.5, "most_s": 2.25}]})");
  const std::string other = (world.folder() / "other.journal").string();
  said_by({"beliefs", "import", file, file, "--journal", other});
  EXPECT_THAT(said_by({"beliefs", "export", "--journal", other}), HasSubstr("15.0"));
  EXPECT_THAT(said_by({"beliefs", "show", "--journal", other}), HasSubstr("93.8 %"));
  EXPECT_THAT(said_by({"beliefs", "show", "--journal", other}),
              testing::ContainsRegex("CameraGone +4 +0.5 s +2.25 s"));
  said_by({"beliefs", "reset", "--journal", other}, 2);
  said_by({"beliefs", "reset", "CameraGone", "--journal", other});
  EXPECT_THAT(said_by({"beliefs", "show", "--journal", other}), HasSubstr("nothing was learned"));
  EXPECT_THAT(said_by({"audit", "verify", "--journal", other}),
              HasSubstr("all as they were written"));
}

}  // namespace
}  // namespace culprit::cli
