// A fleet as its users meet it: a database that is set up, a robot that reports to it, another one
// that begins with what the first learned, and who looks at both.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fleet/test_postgres.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kFleetMember =
    "ROBOT one_camera\n" + replaced_when_gone("camera", "ERROR", "20 10");

struct FleetOfPrograms : testing::Test {
  void SetUp() override {
    if (const std::string why = fleet::TestPostgres::why_not(); !why.empty()) GTEST_SKIP() << why;
    postgres = std::make_unique<fleet::TestPostgres>();
    owner = postgres->address().text;
  }
  std::string said_by(std::vector<std::string> arguments, int code = 0) {
    arguments.insert(arguments.begin(), "culprit");
    TestProgram program(world, std::move(arguments));
    EXPECT_EQ(program.wait(), code) << program.output();
    return program.output();
  }
  std::string journal_of(const std::string& robot) const {
    return (world.folder() / robot / "one_camera.journal").string();
  }
  std::unique_ptr<TestProgram> robot(const std::string& name) {
    return std::make_unique<TestProgram>(
        world,
        std::vector<std::string>{"culprit", "run", rules, "--settle", "1", "--launch", "--healthy",
                                 "1", "--state-dir", (world.folder() / name).string(), "--fleet",
                                 postgres->address("rover").text, "--fleet-name", name});
  }
  bool eventually(const std::string& query) const {
    for (int i = 0; i < 1200; ++i) {
      if (!postgres->query(query).empty()) return true;
      std::this_thread::sleep_for(100ms);
    }
    return false;
  }

  TestWorld world;
  std::unique_ptr<fleet::TestPostgres> postgres;
  std::string owner;
  const std::string rules = world.write("one.rules", kFleetMember);
};

TEST_F(FleetOfPrograms, ASecondRobotBeginsWithWhatTheFirstLearned) {
  EXPECT_THAT(said_by({"fleet", "status", owner}, 1), HasSubstr("run culprit fleet init once"));
  EXPECT_THAT(said_by({"fleet", "init", owner}), AllOf(HasSubstr("made the schema culprit"),
                                                       HasSubstr("made the role culprit_robot")));
  EXPECT_THAT(said_by({"fleet", "init", owner}), HasSubstr("nothing had to be done"));
  postgres->run(
      "CREATE ROLE rover LOGIN IN ROLE culprit_robot; UPDATE culprit.setting SET value = '0' WHERE "
      "name = 'pool_seconds'");
  {
    const auto first = robot("first");
    ASSERT_TRUE(first->prints("camera is there (process ")) << first->output();
    kill(pid_in(first->output(), "camera"), SIGKILL);
    EXPECT_TRUE(eventually("SELECT 1 FROM culprit.failure WHERE ended IS NULL OR how = 'resolved'"))
        << first->output();
    EXPECT_TRUE(eventually("SELECT 1 FROM culprit.outcome WHERE helped = 1")) << first->output();
    first->signal(SIGINT);
    EXPECT_EQ(first->wait(), 0);
    kill(pid_in(first->output(), "camera"), SIGKILL);
  }
  const auto second = robot("second");
  EXPECT_TRUE(second->prints("begins from the priors of 1 robot of one_camera"))
      << second->output();
  ASSERT_TRUE(second->prints("camera is there (process ")) << second->output();
  kill(pid_in(second->output(), "camera"), SIGKILL);
  ASSERT_TRUE(second->prints("camera_redeploy")) << second->output();
  ASSERT_TRUE(second->prints("resolved")) << second->output();
  second->signal(SIGINT);
  EXPECT_EQ(second->wait(), 0);
  kill(pid_in(second->output(), "camera"), SIGKILL);
  EXPECT_THAT(said_by({"replay", journal_of("second")}), HasSubstr("all decided as recorded"));
  EXPECT_THAT(said_by({"log", "--journal", journal_of("second"), "--json"}),
              HasSubstr("priors_adopted"));

  EXPECT_THAT(said_by({"fleet", "status", owner}),
              AllOf(HasSubstr("one_camera"), HasSubstr("none")));
  EXPECT_THAT(said_by({"fleet", "incidents", owner, "--robot", "first"}),
              AllOf(HasSubstr("CameraGone"), HasSubstr("camera_redeploy")));
  EXPECT_THAT(said_by({"fleet", "beliefs", owner, "--json"}), HasSubstr("\"helped\": 1"));
  EXPECT_THAT(said_by({"fleet", "compare", owner}), HasSubstr("all are like the others"));
  EXPECT_THAT(said_by({"fleet", "incidents", owner, "--sql"}), HasSubstr("percentile_cont"));
}

// As where the library is not installed: what is found first in its place is none.
TEST(FleetWithoutItsLibrary, IsToldWhatToInstall) {
  const TestWorld world;
  std::ofstream(world.folder() / "libpq.so.5") << "no library";
  setenv("LD_LIBRARY_PATH", world.folder().c_str(), 1);
  TestProgram status(world, {"culprit", "fleet", "status", "postgresql://localhost/robots"});
  const auto code = status.wait();
  unsetenv("LD_LIBRARY_PATH");
  EXPECT_EQ(code, 1);
  EXPECT_THAT(status.output(), HasSubstr("install libpq5"));
}

TEST_F(FleetOfPrograms, APasswordOnTheCommandLineIsRefusedAndNotRepeated) {
  const std::string address = "postgresql://rover:hunter2@localhost/robots";
  for (const auto& said :
       {said_by({"run", rules, "--fleet", address}, 2), said_by({"fleet", "status", address}, 1)})
    EXPECT_THAT(said, AllOf(HasSubstr("pgpass"), Not(HasSubstr("hunter2"))));
}

}  // namespace
}  // namespace culprit::cli
