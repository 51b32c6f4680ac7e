#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/supervisor.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// A program that runs for a while, and can be taken away and brought back as a build does it.
struct Barred : testing::Test {
  void build() {
    const std::filesystem::path made = folder / "made";
    std::ofstream(made) << "#!/bin/sh\nexec sleep 1000\n";
    std::filesystem::permissions(made, std::filesystem::perms::owner_all);
    std::filesystem::rename(made, folder / "driver");
  }
  std::string program() const { return (folder / "driver").native(); }
  test::TestFolder folder;
};

TEST_F(Barred, AStartWithoutItsProgramSaysWhichOneIsMissingAndWhenItIsBack) {
  Supervised c(program());
  c.supervisor->start({1}, ComponentId(0));
  EXPECT_EQ(c.missing(), "there is no program '" + program() + "', or it is not executable");
  EXPECT_EQ(c.reply_to({1}).outcome, Outcome::kUnreachable);
  build();
  c.nothing_missing();
  EXPECT_NE(c.start(), 0);
}

TEST_F(Barred, AStartWithoutItsParametersSaysWhichFileIsMissing) {
  build();
  const std::string file = (folder / "launch_params_x").native();
  Supervised c(program() + " --ros-args --params-file " + file);
  c.supervisor->start({1}, ComponentId(0));
  EXPECT_EQ(c.missing(), "there is no parameter file '" + file + "'");
  std::ofstream(file) << "/**:\n";
  c.nothing_missing();
  EXPECT_NE(c.start(), 0);
}

TEST_F(Barred, NothingIsEndedThatCouldNotBeStartedAgain) {
  build();
  Supervised c(program());
  const int pid = c.start();
  // Until the shell has read its script, and sleeps.
  while (std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe").filename() !=
         "sleep")
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::filesystem::remove(program());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain);
  EXPECT_EQ(c.missing(), "there is no program '" + program() + "', or it is not executable");
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
  EXPECT_EQ(kill(pid, 0), 0) << "it goes on";
  build();
  c.nothing_missing();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
}

TEST_F(Barred, WhatIsBeingWrittenIsWaitedFor) {
  Supervised c(program());
  c.supervisor->start({1}, ComponentId(0));
  c.missing();
  const Time since = live_now();
  build();
  c.nothing_missing();
  EXPECT_GE(live_now() - since, 500ms) << "a build may still be at it";
}

}  // namespace
}  // namespace culprit::owners
