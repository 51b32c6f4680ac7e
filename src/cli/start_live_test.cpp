// The output at the start of culprit or its demonstration, and the fate of both when the person or
// the terminal is gone.
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "exemplars/sunset/node_process.h"
#include "owners/mark.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

const std::string kRules =
    "ROBOT start\n" + replaced_when_gone("camera") +
    "COMPONENT depth NODE /managed_subsystem/depth LAUNCH \"sunset-node depth\"\n" +
    R"(RULE CameraSilent
  POLICIES WARNING
  TRIGGER rate(/managed_subsystem/rgb_camra) < 1
    STRATEGY camera_restart 90 10
      ADAPTATION camera restart 5
)";

template <class Done>
bool eventually(Done done) {
  for (const Time end = live_now() + TestProgram::kPatience; !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

std::vector<int> nodes_on(std::uint32_t domain) {
  std::vector<int> all;
  for (const sunset::Member member : sunset::kMembers) {
    for (const int pid : sunset::processes_of(member, domain)) all.push_back(pid);
  }
  return all;
}

struct Start : testing::Test {
  TestProgram culprit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "culprit");
    return TestProgram(world, std::move(arguments));
  }
  std::string state() const { return (world.folder() / "state").string(); }
  std::uint32_t domain() const { return ros2::options_from_environment()->domain; }

  TestWorld world;
  const std::string rules = world.write("start.rules", kRules);
};

TEST_F(Start, RunSaysWhatTheRobotHasOfTheRulesAndWhatNot) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  auto run = culprit({"run", rules, "--dry-run", "--state-dir", state()});
  ASSERT_TRUE(run.prints("the robot has no topic '/managed_subsystem/rgb_camra'")) << run.output();
  EXPECT_THAT(run.output(), HasSubstr("camera is /managed_subsystem/camera"));
  EXPECT_THAT(run.output(), HasSubstr("did you mean '/managed_subsystem/rgb_camera'?"));
  EXPECT_THAT(run.output(), HasSubstr("the robot has no node '/managed_subsystem/depth'"));
  auto check = culprit({"check", "--robot", rules});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(check.output(), HasSubstr("camera is /managed_subsystem/camera"));
  auto plan = culprit({"plan", "--robot", rules, "--settle", "1"});
  EXPECT_EQ(plan.wait(), 0);
  EXPECT_THAT(plan.output(), HasSubstr("did you mean '/managed_subsystem/rgb_camera'?"));
}

// A PID in that /proc is another process in culprit's own namespace.
TEST_F(Start, NothingIsManagedByTheProcOfAnotherNamespace) {
  TestProgram run(world, {"unshare", "--pid", "--fork", own_folder() / "culprit", "run", rules,
                          "--state-dir", state()});
  EXPECT_EQ(run.wait(), 1);
  if (run.output().find("unshare failed") != std::string::npos)
    GTEST_SKIP() << "no right to make namespaces";
  EXPECT_THAT(run.output(), HasSubstr("it is of another PID namespace"));
}

TEST_F(Start, RunSaysThatNobodyIsThereAndWaits) {
  const std::string nobody = "no nodes were seen on domain " + std::to_string(domain());
  auto run = culprit({"run", rules, "--state-dir", state(), "--dry-run"});
  ASSERT_TRUE(run.prints(nobody)) << run.output();
  auto plan = culprit({"plan", rules, "--settle", "1"});
  EXPECT_EQ(plan.wait(), 1);
  EXPECT_THAT(plan.output(), HasSubstr(nobody));
  EXPECT_THAT(plan.output(), HasSubstr("--state FILE"));
  EXPECT_THAT(plan.output(), Not(HasSubstr("camera_redeploy")));
  const TestProgram camera(world, {"sunset-node", "camera"});
  EXPECT_TRUE(run.prints("camera is /managed_subsystem/camera")) << run.output();
}

// Its reader has seen enough, or a terminal is gone.
TEST_F(Start, RunGoesOnWhenNobodyReadsItsOutputAnyMore) {
  TestProgram camera(world, {"sunset-node", "camera"});
  const std::string program = own_folder() / "culprit";
  const TestProgram run(world, {"sh", "-c",
                                "{ " + program + " run " + rules + " --settle 1 --state-dir " +
                                    state() + "; echo ended with $? >&2; } | head -n 1"});
  ASSERT_TRUE(run.prints("watching start")) << run.output();
  const std::string journal = state() + "/start.journal";
  ASSERT_TRUE(eventually([&] {
    auto log = culprit({"log", "--journal", journal});
    log.wait();
    return log.output().find("camera is there") != std::string::npos;
  }));
  camera.signal(SIGKILL);
  ASSERT_EQ(camera.wait(), -SIGKILL);
  EXPECT_TRUE(eventually([&] {
    return !sunset::processes_of(sunset::Member::kCamera, domain()).empty();
  })) << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("ended with")));
  for (const int pid : nodes_on(domain())) kill(pid, SIGKILL);
}

TEST_F(Start, ADemosNodesEndWithItAndARobotsNodesDoNotEndWithCulprit) {
  auto run = culprit({"run", rules, "--launch", "--state-dir", state()});
  ASSERT_TRUE(run.prints("camera is there (process ")) << run.output();
  ASSERT_TRUE(run.prints("depth is there (process ")) << run.output();
  run.signal(SIGKILL);
  ASSERT_EQ(run.wait(), -SIGKILL);
  EXPECT_EQ(nodes_on(domain()).size(), 2u);
  for (const int pid : nodes_on(domain())) kill(pid, SIGKILL);

  auto demo = culprit({"demo", "--stay", "--port", "0"});
  ASSERT_TRUE(demo.prints("Break it in the browser")) << demo.output();
  const std::string said = "SUNSET is on domain ";
  ASSERT_THAT(demo.output(), HasSubstr(said));
  const auto demos = static_cast<std::uint32_t>(
      std::atoi(demo.output().c_str() + demo.output().find(said) + said.size()));
  EXPECT_EQ(nodes_on(demos).size(), 7u);
  auto second = culprit({"demo", "--stay", "--port", "0", "--domain", std::to_string(demos)});
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.output(), HasSubstr("the DDS domain " + std::to_string(demos)));
  demo.signal(SIGKILL);
  ASSERT_EQ(demo.wait(), -SIGKILL);
  EXPECT_TRUE(eventually([&] { return nodes_on(demos).empty(); }));
}

// Lifecycle nodes without a manager, and rules that they must be active.
TEST_F(Start, LaunchBringsUpWhatNobodyElseDrives) {
  std::string text = "ROBOT up\n";
  for (const char* name : {"planner", "map", "lidar", "wheels"}) {
    const std::string node = name;
    text += "COMPONENT " + node + " NODE /" + node + " LAUNCH \"ros2_peer_node " +
            std::to_string(domain()) + " /" + node + "\"\nRULE " + node +
            "_down\n  POLICIES ERROR\n  TRIGGER alive(" + node + ") == false || lifecycle(" + node +
            ") != \"active\"\n    STRATEGY " + node + "_redeploy 90 10\n      ADAPTATION " + node +
            " redeploy 5\n";
  }
  text += "DEPENDENCY planner ON map\nDEPENDENCY map ON lidar\n";
  auto run = culprit({"run", world.write("up.rules", text), "--launch", "--state-dir", state()});
  ASSERT_TRUE(run.prints("watching up", 60s)) << run.output();
  for (const char* name : {"planner", "map", "lidar", "wheels"})
    ASSERT_TRUE(run.prints(std::string(name) + " is there (process ")) << run.output();
  EXPECT_LT(run.output().find("starting lidar"), run.output().find("starting planner"));
  kill(pid_in(run.output(), "map"), SIGKILL);
  EXPECT_TRUE(run.prints("map_down resolved by map_redeploy")) << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("STORM")));
  for (const char* other : {"planner_down", "lidar_down", "wheels_down", "is not up"})
    EXPECT_THAT(run.output(), Not(HasSubstr(other)));
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 0);
  for (const char* name : {"planner", "map", "lidar", "wheels"})
    kill(pid_in(run.output(), name), SIGKILL);
}

// It is a lifecycle node without another manager.
TEST_F(Start, WhatWasBeingLaunchedWhenCulpritWasKilledIsBroughtUpByTheNext) {
  const std::string text = "ROBOT half\nCOMPONENT lidar NODE /lidar LAUNCH \"ros2_peer_node " +
                           std::to_string(domain()) +
                           " /lidar\"\nRULE IsUp\n  POLICIES WARNING\n"
                           "  TRIGGER lifecycle(lidar) == \"active\"\n"
                           "    STRATEGY never 90 10 WHEN lifecycle(lidar) == \"finalized\"\n"
                           "      ADAPTATION lidar redeploy 5\n";
  const std::string half = world.write("half.rules", text);
  {
    auto first = culprit({"run", half, "--launch", "--state-dir", state()});
    ASSERT_TRUE(eventually([&] {
      return !owners::launched_as(std::to_string(domain()) + "/half/lidar").empty();
    })) << first.output();
    first.signal(SIGKILL);
    first.wait();
  }
  auto second = culprit({"run", half, "--state-dir", state(), "--settle", "0.5"});
  EXPECT_TRUE(second.prints("bringing up lidar")) << second.output();
  EXPECT_TRUE(second.prints("IsUp")) << second.output();
  EXPECT_FALSE(std::filesystem::exists(state() + "/half.journal-launching"));
  const int lidar = pid_in(second.output(), "lidar");
  ASSERT_GT(lidar, 0) << second.output();
  kill(lidar, SIGKILL);
}

// The first time it was seen to come up, and how long that takes is known.
TEST_F(Start, WhatHangsWhileItIsActivatedIsReplacedSoon) {
  const std::string hang = (world.folder() / "hang").string();
  auto run = culprit(
      {"run",
       world.write("hang.rules", R"(
ROBOT hang
COMPONENT lidar NODE /lidar LAUNCH "ros2_peer_node )" +
                                     std::to_string(domain()) + " --hangs-if " + hang + R"( /lidar"
RULE LidarDown
  POLICIES ERROR
  TRIGGER alive(lidar) == false || lifecycle(lidar) != "active"
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 5
)"),
       "--launch", "--quiet", "0", "--backoff", "0", "--state-dir", state()});
  ASSERT_TRUE(run.prints("lidar is there (process ")) << run.output();
  ASSERT_TRUE(run.prints("watching hang")) << run.output();
  std::ofstream(hang) << "once";
  const Time killed = live_now();
  kill(pid_in(run.output(), "lidar"), SIGKILL);
  EXPECT_TRUE(run.prints("LidarDown resolved by lidar_redeploy")) << run.output();
  // A hang is noticed after 2 s here, and tried anew 1 s later; most of the rest is for slow machines.
  EXPECT_LT(live_now() - killed, 10s) << run.output();
  EXPECT_FALSE(std::filesystem::exists(hang)) << "it did not hang";
  kill(pid_in(run.output(), "lidar"), SIGKILL);
}

// As a service that has nothing of the robot's in its environment.
TEST_F(Start, WhatALaunchNeedsIsSetUpForIt) {
  const auto bin = world.folder() / "bin";
  std::filesystem::create_directory(bin);
  std::filesystem::create_symlink(own_folder() / "ros2_peer_node", bin / "lidar_driver");
  const std::string setup = world.write("setup.bash", "export PATH=" + bin.string() + ":$PATH\n");
  const auto text = [&](const std::string& file) {
    return "ROBOT setup\nCOMPONENT lidar NODE /lidar LAUNCH \"lidar_driver " +
           std::to_string(domain()) + " /lidar\" SETUP " + file + " ENV \"MAP=yard\" CWD " +
           bin.string() +
           "\nRULE LidarGone\n  POLICIES ERROR\n  TRIGGER alive(lidar) == false\n"
           "    STRATEGY lidar_redeploy 90 10\n      ADAPTATION lidar redeploy 5\n";
  };
  auto run =
      culprit({"run", world.write("setup.rules", text(setup)), "--launch", "--state-dir", state()});
  ASSERT_TRUE(run.prints("lidar is there (process ")) << run.output();
  kill(pid_in(run.output(), "lidar"), SIGKILL);
  EXPECT_TRUE(run.prints("LidarGone resolved by lidar_redeploy")) << run.output();
  const std::string process = "/proc/" + std::to_string(pid_in(run.output(), "lidar"));
  EXPECT_EQ(std::filesystem::read_symlink(process + "/cwd"), bin);
  std::ifstream environment(process + "/environ");
  const std::string variables(std::istreambuf_iterator<char>(environment), {});
  EXPECT_THAT(variables, HasSubstr("MAP=yard"));
  auto check = culprit({"check", "--robot", world.write("typo.rules", text(setup + "x"))});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(check.output(), HasSubstr("SETUP: cannot find " + setup + "x"));
  std::filesystem::permissions(setup, std::filesystem::perms(0666));
  auto risky = culprit({"check", "--robot", world.write("risky.rules", text(setup))});
  EXPECT_EQ(risky.wait(), 0);
  EXPECT_THAT(risky.output(), HasSubstr("another user could change it"));
  kill(pid_in(run.output(), "lidar"), SIGKILL);
}

TEST_F(Start, NoContainerIsEndedForOneOfItsNodes) {
  const std::string peer = "ros2_peer_node " + std::to_string(domain());
  TestProgram box(world,
                  {"ros2_peer_node", std::to_string(domain()), "/box", "/detector", "/tracker"});
  auto run = culprit({"run", world.write("composed.rules", R"(
COMPONENT detector NODE /detector LAUNCH ")" + peer + R"( /detector"
RULE DetectorWeak
  POLICIES ERROR ATTEMPTS 1
  TRIGGER parameter(detector, gain) < 5
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 5
)"),
                      "--state-dir", state()});
  EXPECT_TRUE(run.prints("detector lives in the container /box, with /tracker")) << run.output();
  EXPECT_TRUE(run.prints("DetectorWeak is exhausted")) << run.output();
  EXPECT_FALSE(box.wait(100ms)) << "the container was ended";
  EXPECT_THAT(run.output(), Not(HasSubstr("detector is lost")));
}

// As by ros2 launch with respawn=True.
TEST_F(Start, WhatItsLauncherStartsAgainIsEndedAndNotDoubled) {
  const std::string peer = "ros2_peer_node " + std::to_string(domain());
  const TestProgram launcher(
      world, {"sh", "-c", "while :; do " + (own_folder() / peer).string() + " /lidar; done"});
  auto run = culprit({"run", world.write("respawned.rules", R"(
COMPONENT lidar NODE /lidar RESPAWNED LAUNCH ")" + peer + R"( /lidar"
RULE LidarGone
  POLICIES ERROR
  TRIGGER alive(lidar) == false
    STRATEGY lidar_redeploy 90 10
      ADAPTATION lidar redeploy 5
)"),
                      "--state-dir", state()});
  ASSERT_TRUE(run.prints("lidar is there (process ")) << run.output();
  const int first = pid_in(run.output(), "lidar");
  kill(first, SIGSTOP);
  EXPECT_TRUE(run.prints("LidarGone resolved")) << run.output();
  ASSERT_TRUE(eventually([&] { return pid_in(run.output(), "lidar") != first; }));
  EXPECT_FALSE(
      std::filesystem::exists(state() + "/log/" + std::to_string(domain()) + "--lidar.log"))
      << "culprit started one";
  std::ifstream parent("/proc/" + std::to_string(pid_in(run.output(), "lidar")) + "/status");
  const std::string status(std::istreambuf_iterator<char>(parent), {});
  EXPECT_THAT(status, HasSubstr("PPid:\t" + std::to_string(launcher.pid()) + "\n"));
  kill(launcher.pid(), SIGKILL);
  kill(pid_in(run.output(), "lidar"), SIGKILL);
}

TEST_F(Start, ADemoKeepsItsPageWhereAPersonWatches) {
  const std::string demo =
      (own_folder() / "culprit").string() + " demo --scenario 001 --speed 4 --port 0";
  TestProgram watched(world, {"script", "-qec", demo, "/dev/null"});
  ASSERT_TRUE(watched.prints("Ctrl-C ends it", 120s)) << watched.output();
  watched.signal(SIGTERM);
  EXPECT_TRUE(watched.wait().has_value());
  TestProgram scripted(world, {"script", "-qec", demo + " --end", "/dev/null"});
  EXPECT_EQ(scripted.wait(120s), 0) << scripted.output();
}

}  // namespace
}  // namespace culprit::cli
