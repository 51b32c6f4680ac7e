// From a robot that nobody has written rules for to one that is healed: `init`, `check`, `run`.
#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "demo/test_live_sunset.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using sunset::Member;
using testing::HasSubstr;

struct Init : testing::Test {
  // The text of the draft, which is in `file`.
  std::string drafted() {
    TestProgram init(world, {"culprit", "init", "--for", "8", "-o", file});
    EXPECT_EQ(init.wait(60s), 0) << init.output();
    const auto text = read_text(file);
    return text ? *text : text.error();
  }

  TestWorld world;
  const std::string file = (world.folder() / "draft.rules").string();
};

TEST_F(Init, ADraftHealsEachNodeThatIsKilled) {
  const lab::LiveSunset robot(world);
  ASSERT_TRUE(robot.is_well_within(60s)) << robot.complaint();
  const std::string draft = drafted();
  EXPECT_THAT(draft, HasSubstr("|| age(/managed_subsystem/rgb_camera) > "));

  TestProgram check(world, {"culprit", "check", "--robot", "--strict", file});
  EXPECT_EQ(check.wait(), 0) << check.output() << draft;

  TestProgram culprit(world, {"culprit", "run", file, "--settle", "3", "--state-dir",
                              (world.folder() / "state").string()});
  for (const char* name : {"camera", "depth", "image_enhancement", "sensor_fusion", "segmentation"})
    ASSERT_TRUE(culprit.prints(std::string(name) + " is there")) << culprit.output();
  const std::vector<std::pair<Member, std::string>> all = {
      {Member::kCamera, "camera"},
      {Member::kDepth, "depth"},
      {Member::kImageEnhancement, "image_enhancement"},
      {Member::kSensorFusion, "sensor_fusion"},
      {Member::kSegmentation, "segmentation"}};
  for (const auto& [member, name] : all) {
    for (const int pid : robot.processes(member)) kill(pid, SIGKILL);
    EXPECT_TRUE(culprit.prints(name + "_failed resolved by " + name + "_redeploy"))
        << culprit.output() << draft;
    EXPECT_TRUE(robot.is_well_within(60s)) << robot.complaint() << culprit.output();
    EXPECT_EQ(robot.processes(member).size(), 1u);
  }
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
}

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

}  // namespace
}  // namespace culprit::cli
