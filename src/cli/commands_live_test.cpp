// The commands as a user runs them: programs, their output and exit codes, on a live robot.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "json/json.h"
#include "ros2/domain_lock.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// Two nodes of SUNSET, whose silence is a failure.
const std::string kCommandRules =
    "ROBOT two_cameras\n" + replaced_when_gone("camera") + replaced_when_gone("depth");

struct Commands : testing::Test {
  TestProgram culprit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "culprit");
    return TestProgram(world, std::move(arguments));
  }
  std::string state() const { return (world.folder() / "state").string(); }

  TestWorld world;
};

TEST_F(Commands, VersionAndHelp) {
  auto version = culprit({"--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_THAT(version.output(), HasSubstr("culprit "));
  auto help = culprit({"run", "--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_THAT(help.output(), HasSubstr("--dry-run"));
  auto nonsense = culprit({"mend"});
  EXPECT_NE(nonsense.wait(), 0);
}

TEST_F(Commands, SayWhatToInstallWhereTheLaboratoryIsMissing) {
  const auto alone = world.folder() / "culprit";
  std::filesystem::copy_file(own_folder() / "culprit", alone);
  for (const char* command : {"demo", "study", "torture"}) {
    TestProgram missing(world, {"env", "PATH=/usr/bin:/bin", alone, command});
    EXPECT_EQ(missing.wait(), 1);
    EXPECT_THAT(missing.output(), HasSubstr("install it, or build it: cmake --build"));
  }
}

TEST_F(Commands, SayThatTheirOutputIsNotWhole) {
  const std::string program = own_folder() / "culprit";
  TestProgram few(world, {"sh", "-c", program + " explain R001 > /dev/full"});
  EXPECT_EQ(few.wait(), 1);
  EXPECT_THAT(few.output(), HasSubstr("not all of the output could be written: No space left"));
  std::string mistakes;
  for (int i = 0; i < 300; ++i) mistakes += "!\n";
  const std::string check = program + " check --format json " + world.write("bad.rules", mistakes);
  TestProgram many(world, {"sh", "-c", check + " > /dev/full"});
  EXPECT_EQ(many.wait(), 1);
  EXPECT_THAT(many.output(), HasSubstr("not all of the output could be written: No space left"));
}

TEST_F(Commands, CheckShowsEveryMistake) {
  auto good = culprit({"check", world.write("good.rules", kCommandRules)});
  EXPECT_EQ(good.wait(), 0) << good.output();
  EXPECT_THAT(good.output(), HasSubstr("2 rules"));

  auto bad = culprit({"check", world.write("bad.rules",
                                           "COMPONENT c NODE /c\nRULE r\n  POLICIES EROR\n"
                                           "  TRIGGER rate(/t < 3\n    STRATEGY s 150 10\n"
                                           "      ADAPTATION c restart 1\n")});
  EXPECT_EQ(bad.wait(), 1);
  EXPECT_THAT(bad.output(), HasSubstr("bad.rules:3:"));
  EXPECT_THAT(bad.output(), HasSubstr("bad.rules:4:"));
  EXPECT_THAT(bad.output(), HasSubstr("bad.rules:5:"));
  EXPECT_THAT(bad.output(), HasSubstr("ERROR"));  // what EROR was meant to be

  auto missing = culprit({"check", (world.folder() / "nowhere.rules").string()});
  EXPECT_EQ(missing.wait(), 1);
  EXPECT_THAT(missing.output(), HasSubstr("nowhere.rules"));
}

TEST_F(Commands, CheckPrintsNothingButTheDocumentForPrograms) {
  const std::string good = world.write("good.rules", kCommandRules);
  const std::string bad = world.write("bad.rules", "robot x\n");
  auto json = culprit({"check", "--format", "json", good, bad});
  EXPECT_EQ(json.wait(), 1);
  const auto found = parse_json(json.output());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0]["code"], "R001");
  auto sarif = culprit({"check", "--format", "sarif", good});
  EXPECT_EQ(sarif.wait(), 0);
  EXPECT_TRUE(parse_json(sarif.output())["runs"][0]["results"].empty());
  auto nonsense = culprit({"check", "--format", "xml", good});
  EXPECT_EQ(nonsense.wait(), 2);
}

TEST_F(Commands, CheckComparesWithTheRobot) {
  const std::string good = world.write("good.rules", R"(
COMPONENT camera NODE /managed_subsystem/camera
RULE CameraSlow
  POLICIES WARNING
  TRIGGER rate(/managed_subsystem/rgb_camera) < 1 && lifecycle(camera) == "active"
    STRATEGY tune 50 10
      ADAPTATION camera set_parameter image_degradation 0.1 2
)");
  const std::string bad = world.write("bad.rules", R"(
COMPONENT camera NODE /managed_subsystem/camrea
COMPONENT depth
RULE CameraSlow
  POLICIES WARNING
  TRIGGER rate(/managed_subsystem/rgb_camra) < 1
    STRATEGY restart 50 10
      ADAPTATION camera restart 2
    STRATEGY tune 50 10
      ADAPTATION /managed_subsystem/camera set_parameter image_degradaton 0.1 2
)");
  auto alone = culprit({"check", "--robot", "--wait", "0.5", good});
  EXPECT_EQ(alone.wait(), 1) << "there is no robot yet";
  EXPECT_THAT(alone.output(), HasSubstr("ROS_DOMAIN_ID"));

  const std::string broken =
      world.write("broken.rules", "COMPONENT camera\nRULE R\n  POLICIES ERROR\n");
  auto uncompared = culprit({"check", "--robot", broken});
  EXPECT_EQ(uncompared.wait(), 1);
  EXPECT_THAT(uncompared.output(),
              testing::AllOf(HasSubstr("error["), HasSubstr("no file without errors"),
                             Not(HasSubstr("no nodes were seen"))));

  const TestProgram camera(world, {"sunset-node", "camera"});
  auto right = culprit({"check", "--robot", good});
  EXPECT_EQ(right.wait(), 0);
  EXPECT_THAT(right.output(), Not(HasSubstr("warning"))) << right.output();
  auto wrong = culprit({"check", "--robot", "--format", "json", bad});
  EXPECT_EQ(wrong.wait(), 0) << "a robot changes: these are warnings";
  std::vector<std::string> found;
  for (const auto& d : parse_json(wrong.output())) {
    found.push_back(d["code"].get<std::string>() + " " +
                    (d.contains("fix") ? d["fix"]["text"].get<std::string>() : "-"));
  }
  EXPECT_THAT(found,
              testing::ElementsAre("R060 /managed_subsystem/camera", "R060 -",
                                   "R061 /managed_subsystem/rgb_camera", "R062 image_degradation"));
}

TEST_F(Commands, NameTheDomainsOfThisMachineWhereTheySeeNoRobot) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  auto joined = culprit({"graph"});
  ASSERT_EQ(joined.wait(), 0);
  ASSERT_THAT(joined.output(), HasSubstr("/managed_subsystem/camera"));
  const auto elsewhere = ros2::DomainLock::reserve();
  ASSERT_TRUE(elsewhere) << elsewhere.error();
  setenv("ROS_DOMAIN_ID", std::to_string(elsewhere->domain()).c_str(), 1);
  const std::string rules = world.write("two.rules", kCommandRules);
  auto check = culprit({"check", "--robot", "--wait", "0.5", rules});
  EXPECT_EQ(check.wait(), 1);
  EXPECT_THAT(check.output(), HasSubstr("Processes of this machine are on domain "));
  auto graph = culprit({"graph", "--wait", "0.5"});
  EXPECT_EQ(graph.wait(), 0);
  EXPECT_THAT(graph.output(), HasSubstr("Processes of this machine are on domain "));
}

TEST_F(Commands, ExplainShowsThePageOfACode) {
  auto page = culprit({"explain", "R012"});
  EXPECT_EQ(page.wait(), 0);
  EXPECT_THAT(page.output(), HasSubstr("--strict"));
  auto all = culprit({"explain"});
  EXPECT_EQ(all.wait(), 0);
  EXPECT_THAT(all.output(), HasSubstr("R001  "));
  auto unknown = culprit({"explain", "R999"});
  EXPECT_EQ(unknown.wait(), 2);
  EXPECT_THAT(unknown.output(), HasSubstr("R999"));
}

TEST_F(Commands, GraphShowsTheRobot) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  auto graph = culprit({"graph", "--json"});
  ASSERT_EQ(graph.wait(), 0) << graph.output();
  const auto json = parse_json(graph.output());
  EXPECT_THAT(to_line(json), HasSubstr("/managed_subsystem/camera"));
  EXPECT_THAT(to_line(json), HasSubstr(std::to_string(camera.pid())));
  auto dot = culprit({"graph", "--dot"});
  ASSERT_EQ(dot.wait(), 0);
  EXPECT_THAT(dot.output(), HasSubstr("digraph"));
}

TEST_F(Commands, PlanLooksAtTheRobotAndLeavesItAsItIs) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  auto plan =
      culprit({"plan", world.write("two.rules", kCommandRules), "--robot", "--format", "json"});
  ASSERT_EQ(plan.wait(), 0) << plan.output();
  const auto json = parse_json(plan.output().substr(plan.output().find('{')));
  EXPECT_TRUE(json["failures"].empty()) << "what was never seen is not gone: " << json;
  EXPECT_THAT(to_line(json["unknown"]), HasSubstr("alive(depth)"));
  auto graph = culprit({"graph"});
  ASSERT_EQ(graph.wait(), 0);
  EXPECT_THAT(graph.output(), Not(HasSubstr("/managed_subsystem/depth"))) << "it was started";
  EXPECT_THAT(graph.output(), HasSubstr("/managed_subsystem/camera  (process " +
                                        std::to_string(camera.pid()) + ")"));
}

TEST_F(Commands, RunAdoptsWhatRunsStartsWhatIsMissingAndLeavesTheRobotAsItIs) {
  TestProgram camera(world, {"sunset-node", "camera"});
  auto run =
      culprit({"run", world.write("two.rules", kCommandRules), "--launch", "--state-dir", state()});
  ASSERT_TRUE(run.prints("starting depth")) << run.output();
  ASSERT_TRUE(run.prints("depth is there (process ")) << run.output();
  ASSERT_TRUE(run.prints("camera is there (process ")) << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("starting camera")));
  EXPECT_EQ(pid_in(run.output(), "camera"), camera.pid());

  // The adopted one is relaunched as well as its own.
  camera.signal(SIGKILL);
  ASSERT_EQ(camera.wait(), -SIGKILL);
  ASSERT_TRUE(run.prints("CameraGone resolved by camera_redeploy")) << run.output();
  const int relaunched = pid_in(run.output(), "camera");
  const int depth = pid_in(run.output(), "depth");
  EXPECT_NE(relaunched, camera.pid());

  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 0);
  EXPECT_THAT(run.output(), HasSubstr("the robot goes on as it is"));
  EXPECT_EQ(kill(relaunched, SIGKILL), 0) << "the camera did not outlive culprit";
  EXPECT_EQ(kill(depth, SIGKILL), 0) << "the depth camera did not outlive culprit";
}

TEST_F(Commands, RunSaysWhatItWouldDoAndDoesNothing) {
  TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram depth(world, {"sunset-node", "depth"});
  auto run = culprit(
      {"run", world.write("two.rules", kCommandRules), "--dry-run", "--state-dir", state()});
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  ASSERT_TRUE(run.prints("depth is there")) << run.output();
  camera.signal(SIGKILL);
  camera.wait();
  ASSERT_TRUE(run.prints("would redeploy camera")) << run.output();
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait(), 0);
  EXPECT_EQ(pid_in(run.output(), "camera"), camera.pid()) << run.output();
}

TEST_F(Commands, RunSaysWhyAComponentCannotBeStarted) {
  auto run = culprit({"run", world.write("none.rules", R"(
COMPONENT ghost NODE /ghost LAUNCH "no-such-program --at all"
RULE GhostGone
  POLICIES ERROR ATTEMPTS 1
  TRIGGER alive(ghost) == false
    STRATEGY ghost_start 90 10
      ADAPTATION ghost start 5
)"),
                      "--launch", "--settle", "0", "--state-dir", state()});
  EXPECT_TRUE(run.prints("no-such-program")) << run.output();
  EXPECT_TRUE(run.prints("GhostGone waits: ghost cannot be started")) << run.output();
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 0);
}

TEST_F(Commands, ABadEnvironmentIsAnError) {
  setenv("ROS_DOMAIN_ID", "many", 1);
  auto graph = culprit({"graph"});
  EXPECT_NE(graph.wait(), 0);
  EXPECT_THAT(graph.output(), HasSubstr("ROS_DOMAIN_ID"));
}

}  // namespace
}  // namespace culprit::cli
