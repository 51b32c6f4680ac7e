// Culprit started a node, and another launcher starts it, too: a launch file that comes late, or one that restarts its nodes. Two nodes of one name are worse
// than either; culprit ends its own, and only that.
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "owners/proc.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

struct Doubled : testing::Test {
  TestProgram run(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{
        "culprit", "run",        rules,      "--state-dir", (world.folder() / "state").string(),
        "--quiet", "0",          "--settle", "0.5",         "--backoff",
        "0",       "--restarts", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return TestProgram(world, std::move(arguments));
  }
  TestProgram node(const std::string& name) {
    return TestProgram(world, {"ros2_peer_node", domain, name});
  }
  std::string declared(const std::string& name, const std::string& launch) const {
    return "COMPONENT " + name + " NODE /" + name + " LAUNCH \"" + launch + "\"\nRULE " + name +
           "_gone\n  POLICIES ERROR\n  TRIGGER alive(" + name + ") == false\n    STRATEGY " + name +
           "_redeploy 90 10\n      ADAPTATION " + name + " redeploy 5\n";
  }
  // A process of which only its exit code is left does not run, though it can be signalled.
  static bool runs(int pid) { return owners::state_letter(pid).value_or('Z') != 'Z'; }
  static bool ends(int pid) {
    for (const Time end = later(live_now(), TestProgram::kPatience); live_now() < end;
         std::this_thread::sleep_for(20ms)) {
      if (!runs(pid)) return true;
    }
    return false;
  }
  // The process of a lidar that a culprit started which was killed then.
  int left_by_an_earlier_culprit() {
    auto culprit = run({"--launch"});
    EXPECT_TRUE(culprit.prints("lidar is there (process ")) << culprit.output();
    const int lidar = pid_in(culprit.output(), "lidar");
    culprit.signal(SIGKILL);
    culprit.wait();
    return lidar;
  }
  // Culprit may want to start one again when it ends one.
  void expect_one_for_a_while(const TestProgram& culprit, int pid) {
    std::this_thread::sleep_for(3s);  // that nothing happens takes time
    EXPECT_TRUE(runs(pid)) << "what was somebody else's was ended\n" << culprit.output();
    EXPECT_THAT(culprit.output(), Not(HasSubstr("lidar_redeploy: done")));
  }

  TestWorld world;
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
  const std::string rules =
      world.write("doubled.rules",
                  "ROBOT doubled\n" + declared("lidar", "ros2_peer_node " + domain + " /lidar"));
};

TEST_F(Doubled, WhatALaunchFileStartsLateIsLeftAndOursIsWithdrawn) {
  const auto culprit = run({"--launch"});
  ASSERT_TRUE(culprit.prints("watching doubled")) << culprit.output();
  ASSERT_TRUE(culprit.prints("lidar is there (process ")) << culprit.output();
  const int ours = pid_in(culprit.output(), "lidar");
  const auto others = node("/lidar");
  EXPECT_TRUE(culprit.prints("lidar runs twice: culprit started one, and there is process " +
                             std::to_string(others.pid())))
      << culprit.output();
  EXPECT_TRUE(ends(ours));
  expect_one_for_a_while(culprit, others.pid());
}

// It died, and both started it again.
TEST_F(Doubled, WhatItsLauncherStartsAgainLaterIsLeftAndOursIsWithdrawn) {
  const TestProgram launcher(world, {"sh", "-c",
                                     "while :; do " + (own_folder() / "ros2_peer_node").string() +
                                         " " + domain + " /lidar; sleep 2; done"});
  const auto culprit = run();
  ASSERT_TRUE(culprit.prints("lidar is there (process ")) << culprit.output();
  const int first = pid_in(culprit.output(), "lidar");
  ASSERT_GT(first, 0) << culprit.output();
  kill(first, SIGKILL);
  ASSERT_TRUE(culprit.prints("lidar_gone resolved by lidar_redeploy")) << culprit.output();
  ASSERT_TRUE(culprit.prints("lidar runs twice: culprit started one, and there is process "))
      << culprit.output();
  const auto is_its = [&](int pid) {
    std::ifstream status("/proc/" + std::to_string(pid) + "/status");
    return std::string(std::istreambuf_iterator<char>(status), {})
               .find("PPid:\t" + std::to_string(launcher.pid()) + "\n") != std::string::npos;
  };
  const std::string said = "culprit started one, and there is process ";
  const std::string output = culprit.output();
  const int last = std::atoi(output.c_str() + output.find(said) + said.size());
  ASSERT_GT(last, 0) << output;
  EXPECT_TRUE(is_its(last)) << output;
  std::this_thread::sleep_for(3s);  // that nothing happens takes time
  EXPECT_TRUE(runs(last)) << culprit.output();
  kill(launcher.pid(), SIGKILL);
  kill(last, SIGKILL);
}

// The launch file came while no culprit ran.
TEST_F(Doubled, WhatAnEarlierCulpritStartedIsWithdrawn) {
  const int ours = left_by_an_earlier_culprit();
  const auto others = node("/lidar");
  const auto culprit = run();
  EXPECT_TRUE(culprit.prints("lidar runs twice: culprit started one")) << culprit.output();
  EXPECT_TRUE(ends(ours));
  expect_one_for_a_while(culprit, others.pid());
}

// A person paused it, or only wants to know.
TEST_F(Doubled, NothingIsEndedWhereCulpritIsToDoNothing) {
  const int ours = left_by_an_earlier_culprit();
  const auto others = node("/lidar");
  const auto culprit = run({"--dry-run"});
  EXPECT_TRUE(culprit.prints("several nodes have the name /lidar")) << culprit.output();
  std::this_thread::sleep_for(1s);  // that nothing happens takes time
  EXPECT_TRUE(runs(ours));
  EXPECT_TRUE(runs(others.pid()));
  EXPECT_THAT(culprit.output(), Not(HasSubstr("runs twice")));
  if (ours > 0) kill(ours, SIGKILL);
}

// The launch makes two nodes, and only one of them is doubled; neither may be missing.
TEST_F(Doubled, WhatElseWouldEndIsNotEnded) {
  const std::string peer = (own_folder() / "ros2_peer_node").string() + " " + domain;
  const std::string both =
      world.write("both.sh", "#!/bin/sh\n" + peer + " /camera &\n" + peer + " /lidar &\nwait\n");
  std::filesystem::permissions(both, std::filesystem::perms(0755));
  const std::string text = "ROBOT doubled\n" + declared("lidar", both);
  world.write("doubled.rules", text);
  const auto culprit = run({"--launch"});
  ASSERT_TRUE(culprit.prints("watching doubled")) << culprit.output();
  ASSERT_TRUE(culprit.prints("lidar is there (process ")) << culprit.output();
  const int ours = pid_in(culprit.output(), "lidar");
  const auto lidar = node("/lidar");
  EXPECT_TRUE(culprit.prints("several nodes have the name /lidar")) << culprit.output();
  std::this_thread::sleep_for(1s);  // that nothing happens takes time
  EXPECT_TRUE(runs(ours)) << culprit.output();
  EXPECT_THAT(culprit.output(), Not(HasSubstr("runs twice")));
  const auto camera = node("/camera");
  EXPECT_TRUE(culprit.prints("lidar runs twice: culprit started one")) << culprit.output();
  EXPECT_TRUE(ends(ours));
  expect_one_for_a_while(culprit, lidar.pid());
}

}  // namespace
}  // namespace culprit::cli
