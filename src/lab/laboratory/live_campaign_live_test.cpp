// A campaign on the live robot, as a person leaves it alone for a night.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "terminal/test_program.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class LiveCampaign : public testing::Test {
 protected:
  LiveCampaign() { setenv("TMPDIR", world_.folder().c_str(), 1); }
  ~LiveCampaign() override { unsetenv("TMPDIR"); }

  // Two runs on the live robot, both at once, and two on its model.
  std::vector<std::string> command() const {
    return {"culprit-lab", "study", "sunset", "--live", "--ablation",   "--planner", "bayes",
            "--runs",      "2",     "--jobs", "2",      "--shard-file", file_};
  }

  // The processes of runs, and of their robots: by the folder that they were given.
  int processes() const {
    const std::string mark = "TMPDIR=" + (world_.folder() / "culprit-live-").string();
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc"))
      count += contents(entry.path() / "environ").find(mark) == std::string::npos ? 0 : 1;
    return count;
  }
  template <class Done>
  static bool eventually(Done done) {
    for (int i = 0; i < 1200; ++i) {
      if (done()) return true;  // it may be over a moment later
      std::this_thread::sleep_for(50ms);
    }
    return false;
  }

  const TestWorld world_;
  const std::string file_ = (world_.folder() / "live").string();
};

TEST_F(LiveCampaign, GoesOnAfterItWasKilledAndLeavesNoProcessBehind) {
  {
    TestProgram killed(world_, command());
    ASSERT_TRUE(eventually([&] { return processes() >= 2 * 7; })) << killed.output();
    killed.signal(SIGKILL);
    killed.wait();
    EXPECT_TRUE(eventually([&] { return processes() == 0; }));
  }
  TestProgram again(world_, command());
  ASSERT_EQ(again.wait(8min), 0) << again.output();
  EXPECT_THAT(again.output(), testing::HasSubstr("2 of 4 runs are there already"));
  EXPECT_EQ(processes(), 0);

  TestProgram merge(world_, {"culprit-lab", "study", "merge", file_});
  ASSERT_EQ(merge.wait(), 0) << merge.output();
  EXPECT_THAT(merge.output(), testing::HasSubstr("The live robot beside its model"));
}

TEST_F(LiveCampaign, EndsItsRobotsWhenItIsAskedTo) {
  TestProgram stopped(world_, command());
  ASSERT_TRUE(eventually([&] { return processes() >= 2 * 7; })) << stopped.output();
  stopped.signal(SIGINT);
  EXPECT_EQ(stopped.wait(1min), 1) << stopped.output();
  EXPECT_THAT(stopped.output(), testing::HasSubstr("the same command goes on from there"));
  EXPECT_EQ(processes(), 0);
}

}  // namespace
}  // namespace culprit::lab
