// `init` where there is nothing to draft. Drafts are tested in first_hour_live_test.cpp.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

struct Init : testing::Test {
  TestWorld world;
  const std::string file = (world.folder() / "draft.rules").string();
};

TEST_F(Init, AnEmptyDomainIsNoRobotAndNoFileIsWritten) {
  TestProgram init(world, {"culprit", "init", "--for", "5", "-o", file});
  EXPECT_EQ(init.wait(), 1);
  EXPECT_THAT(init.output(), HasSubstr("is ROS_DOMAIN_ID the robot's?"));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(Init, AFileThatIsThereIsNotOverwritten) {
  ASSERT_TRUE(write_text(file, "# mine\n"));
  TestProgram init(world, {"culprit", "init", "-o", file});
  EXPECT_EQ(init.wait(), 2);
  EXPECT_THAT(init.output(), HasSubstr("is there already"));
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, "# mine\n");
}

TEST_F(Init, BesideARunningCulpritNothingIsDraftedOfCulprit) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const std::string rules = world.write(
      "robot.rules",
      "ROBOT watched\nCOMPONENT camera NODE /managed_subsystem/camera\nRULE Lost\n  POLICIES "
      "ERROR REPORT\n  TRIGGER !alive(camera)\n");
  const TestProgram culprit(world, {"culprit", "run", rules, "--dry-run"});
  ASSERT_TRUE(culprit.prints("watching watched")) << culprit.output();
  TestProgram init(world, {"culprit", "init", "--for", "5", "-o", file});
  EXPECT_EQ(init.wait(), 0) << init.output();
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr("\nCOMPONENT camera "));
  EXPECT_THAT(*text, Not(HasSubstr("culprit:"))) << "its diagnostics";
  EXPECT_THAT(*text, Not(HasSubstr("level(culprit"))) << *text;
  EXPECT_THAT(*text, Not(HasSubstr("NODE /culprit")));
  EXPECT_THAT(*text, Not(HasSubstr("# /culprit"))) << "left out";
}

// culprit may run elsewhere than where the draft was made, as a service does.
TEST_F(Init, ACommandWithARelativePathKeepsItsFolder) {
  const std::string kept = std::filesystem::relative(world.write("kept", "")).string();
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
  const TestProgram node(world, {"ros2_peer_node", domain, "--keeps-if", kept, "/camera"});
  TestProgram init(world, {"culprit", "init", "--for", "5", "-o", file});
  EXPECT_EQ(init.wait(), 0) << init.output();
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr("--keeps-if " + kept + " /camera\""));
  EXPECT_THAT(*text, HasSubstr(" CWD \"" + std::filesystem::current_path().string() + "\""));
}

// Each run has another one, and an update would replace every component.
TEST_F(Init, TheLogFolderOfOneLaunchIsNoPartOfAStart) {
  setenv("ROS_LOG_DIR", "/home/robot/.ros/log/2026-11-30-20-03-11-512345-rover-4711", 1);
  setenv("ROS_HOME", "/data/ros", 1);
  const TestProgram camera(world, {"sunset-node", "camera"});
  unsetenv("ROS_LOG_DIR");
  unsetenv("ROS_HOME");
  TestProgram init(world, {"culprit", "init", "--for", "5", "-o", file});
  EXPECT_EQ(init.wait(), 0) << init.output();
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr("ROS_HOME=/data/ros"));
  EXPECT_THAT(*text, Not(HasSubstr("ROS_LOG_DIR")));
}

TEST_F(Init, AnUpdateTakesALaunchDump) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram init(world, {"culprit", "init", "--for", "5", "-o", file});
  ASSERT_EQ(init.wait(), 0) << init.output();
  const std::string dump =
      world.write("system_model.yaml",
                  "structure:\n  nodes:\n    /managed_subsystem/camera: {pkg: sunset, "
                  "exec: camera, node_name: camera, respawn: true}\n");
  TestProgram update(
      world, {"culprit", "init", "--for", "5", "--update", file, "--launch", dump, "-o", file});
  EXPECT_EQ(update.wait(), 0) << update.output();
  EXPECT_THAT(update.output(), HasSubstr(" RESPAWNED\n"));
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, HasSubstr(" RESPAWNED\n"));
}

TEST_F(Init, AnUpdateIsNotWrittenOverWhatSomebodyChangedMeanwhile) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  std::string mine = "COMPONENT mine NODE /mine\n";
  ASSERT_TRUE(write_text(file, mine));
  TestProgram init(world, {"culprit", "init", "--for", "5", "--update", file, "-o", file});
  std::optional<int> status;
  while (!(status = init.wait(50ms))) {
    mine += "# a thought\n";
    ASSERT_TRUE(write_text(file + ".new", mine));
    std::filesystem::rename(file + ".new", file);
  }
  EXPECT_EQ(status, 1) << init.output();
  EXPECT_THAT(init.output(), HasSubstr("was changed while the robot was watched"));
  const auto text = read_text(file);
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, mine);
}

}  // namespace
}  // namespace culprit::cli
