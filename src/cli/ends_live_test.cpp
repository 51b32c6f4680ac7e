// Ends of nodes, as reported by the operating system: a killed one is not waited for, and a launch
// that a person ends is not started again.
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "owners/proc.h"
#include "owners/test_control_group.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

struct Ends : testing::Test {
  TestProgram run(const std::string& rules) {
    return TestProgram(world,
                       {"culprit", "run", world.write("ends.rules", rules), "--state-dir",
                        (world.folder() / "state").string(), "--quiet", "0", "--settle", "0.5"});
  }
  std::string node(const std::string& name) const {
    return (own_folder() / "ros2_peer_node").string() + " " + domain + " /" + name;
  }
  std::string rule(const std::string& name, const std::string& trigger) const {
    return "COMPONENT " + name + " NODE /" + name + " LAUNCH \"" + node(name) + "\"\nRULE " + name +
           "_silent\n  POLICIES ERROR\n  TRIGGER " + trigger + "\n    STRATEGY " + name +
           "_redeploy 90 10\n      ADAPTATION " + name + " redeploy 5\n";
  }

  TestWorld world;
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
};

// Its rule would wait for minutes. The node is the test's, and the one after it culprit's own.
TEST_F(Ends, AKilledNodeIsReplacedBeforeItsSilenceIsHeard) {
  const TestProgram lidar(world, {"ros2_peer_node", domain, "/lidar"});
  const auto culprit = run(rule("lidar", "age(/lidar/value) > 5min") +
                           "RULE lidar_inactive\n  POLICIES WARNING\n  TRIGGER lifecycle(lidar) == "
                           "\"unconfigured\"\n    STRATEGY bring_up 90 10\n      ADAPTATION lidar "
                           "activate 5\n");
  int killed = lidar.pid();
  for (const char* whose : {"of the test", "of culprit"}) {
    ASSERT_TRUE(culprit.prints("lidar is there (process " + std::to_string(killed) + ")"))
        << whose << culprit.output();
    ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
    std::this_thread::sleep_for(2500ms);  // it speaks, and the quiet time after its start is over
    kill(killed, SIGKILL);
    const int before = killed;
    for (const Time end = later(live_now(), TestProgram::kPatience); live_now() < end;) {
      killed = pid_in(culprit.output(), "lidar");
      if (killed != before) break;
      std::this_thread::sleep_for(20ms);
    }
    ASSERT_NE(killed, before) << whose << culprit.output();
  }
  EXPECT_THAT(culprit.output(), HasSubstr("lidar is known to be down, killed by signal 9"));
  kill(killed, SIGKILL);
}

// As `systemctl freeze` and `docker pause`: its process looks as if it slept, and does nothing.
TEST_F(Ends, AFrozenNodeIsLeftAloneUntilItIsThawed) {
  const owners::TestControlGroup group;
  if (!group.is_there()) GTEST_SKIP() << "this machine lets nobody make a control group";
  const TestProgram lidar(world, {"ros2_peer_node", domain, "/lidar"});
  group.take(lidar.pid());
  const auto culprit = run(rule("lidar", "alive(lidar) == false"));
  ASSERT_TRUE(culprit.prints("lidar is there (process " + std::to_string(lidar.pid()) + ")"))
      << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  std::this_thread::sleep_for(1s);
  group.freeze();
  EXPECT_TRUE(culprit.prints("lidar stays down: a person froze it")) << culprit.output();
  std::this_thread::sleep_for(8s);  // one that hangs would have been replaced
  group.freeze(false);
  EXPECT_TRUE(culprit.prints("lidar_silent cleared")) << culprit.output();
  EXPECT_EQ(pid_in(culprit.output(), "lidar"), lidar.pid()) << culprit.output();
  kill(lidar.pid(), SIGKILL);
}

// As Ctrl-C on a launch file: all are asked to end at once, and end one after the other.
TEST_F(Ends, ALaunchOfFiveThatSomebodyEndsIsNotStartedAgain) {
  std::string rules;
  std::string launch;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    rules += rule(name, std::string("alive(") + name + ") == false");
    launch += node(name) + " & all=\"$all $!\"; ";
  }
  TestProgram launcher(world, {"sh", "-c",
                               launch + "trap 'for p in $all; do kill $p; sleep 0.2; done; wait; "
                                        "exit' TERM; while :; do sleep 0.1; done"});
  const auto culprit = run(rules);
  for (const char* name : {"a", "b", "c", "d", "e"})
    ASSERT_TRUE(culprit.prints(std::string(name) + " is there (process ")) << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  std::this_thread::sleep_for(1s);
  launcher.signal(SIGTERM);
  for (const char* name : {"a", "b", "c", "d", "e"})
    EXPECT_TRUE(culprit.prints(std::string(name) +
                               "_redeploy is held back: a person ended the launch of process " +
                               std::to_string(launcher.pid())))
        << culprit.output();
  std::this_thread::sleep_for(2s);  // that nothing happens takes time
  EXPECT_THAT(culprit.output(), Not(HasSubstr("is held responsible")));
}

// A launch of two, of which one was killed by `signal` and replaced by culprit.
struct Healed {
  std::string rules;
  std::unique_ptr<TestProgram> launcher;
  std::unique_ptr<TestProgram> culprit;
  int stand_in = 0;
  int other = 0;  // the one that the launcher still runs
};

struct EndsHealed : Ends {
  // `script`: what the launcher does on SIGTERM, with $all.
  Healed healed(const std::string& script, const std::vector<std::string>& more = {}) {
    Healed all;
    std::string launch;
    for (const char* name : {"a", "b"}) {
      all.rules += rule(name, std::string("alive(") + name + ") == false");
      launch += node(name) + " & all=\"$all $!\"; ";
    }
    all.launcher = std::make_unique<TestProgram>(
        world, std::vector<std::string>{
                   "sh", "-c", launch + "trap '" + script + "' TERM; while :; do sleep 0.1; done"});
    all.culprit = start(all.rules, more);
    for (const char* name : {"a", "b"})
      EXPECT_TRUE(all.culprit->prints(std::string(name) + " is there (process "))
          << all.culprit->output();
    EXPECT_TRUE(all.culprit->prints("watching")) << all.culprit->output();
    std::this_thread::sleep_for(1s);
    const int first = pid_in(all.culprit->output(), "a");
    all.other = pid_in(all.culprit->output(), "b");
    kill(first, SIGKILL);
    EXPECT_TRUE(all.culprit->prints("a_silent resolved by a_redeploy")) << all.culprit->output();
    all.stand_in = pid_in(all.culprit->output(), "a");
    EXPECT_NE(all.stand_in, first);
    return all;
  }
  std::unique_ptr<TestProgram> start(const std::string& rules,
                                     const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"culprit",
                                       "run",
                                       world.write("ends.rules", rules),
                                       "--state-dir",
                                       (world.folder() / "state").string(),
                                       "--quiet",
                                       "0",
                                       "--settle",
                                       "0.5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<TestProgram>(world, arguments);
  }
  std::string said_by(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"culprit"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    TestProgram program(world, all);
    program.wait();
    return program.output();
  }
  static bool is_gone(int pid) { return owners::state_letter(pid).value_or('Z') == 'Z'; }
  static bool goes(int pid) {
    for (const Time end = later(live_now(), TestProgram::kPatience); !is_gone(pid);) {
      if (live_now() > end) return false;
      std::this_thread::sleep_for(20ms);
    }
    return true;
  }
  static constexpr const char* kEndsAll = "for p in $all; do kill $p; done; wait; exit";
};

TEST_F(EndsHealed, WhatStandsInForOneOfALaunchEndsWithIt) {
  const Healed all = healed(kEndsAll);
  EXPECT_THAT(said_by({"status"}),
              HasSubstr("Started by culprit: a (process " + std::to_string(all.stand_in) + ")"));
  std::this_thread::sleep_for(2s);  // a person is slower than on_exit
  all.launcher->signal(SIGTERM);
  EXPECT_TRUE(all.culprit->prints("a and b stay down: a person ended the launch of process " +
                                  std::to_string(all.launcher->pid())))
      << all.culprit->output();
  EXPECT_TRUE(goes(all.stand_in)) << all.culprit->output();
  std::this_thread::sleep_for(3s);  // that nothing happens takes time
  EXPECT_EQ(pid_in(all.culprit->output(), "a"), all.stand_in) << all.culprit->output();
  EXPECT_EQ(pid_in(all.culprit->output(), "b"), all.other) << all.culprit->output();
  EXPECT_THAT(said_by({"status"}), HasSubstr("Stays down: b: a person ended the launch"));
  // One command brings it back.
  said_by({"revive"});
  EXPECT_TRUE(all.culprit->prints("b_silent resolved by b_redeploy")) << all.culprit->output();
  EXPECT_TRUE(all.culprit->prints("a_silent resolved by a_redeploy")) << all.culprit->output();
  EXPECT_THAT(said_by({"end-started"}), HasSubstr("end the processes that culprit started"));
  EXPECT_TRUE(goes(pid_in(all.culprit->output(), "a"))) << all.culprit->output();
  EXPECT_TRUE(goes(pid_in(all.culprit->output(), "b"))) << all.culprit->output();
}

// As with on_exit=Shutdown(), unless culprit is configured for such a launch file.
TEST_F(EndsHealed, ALaunchThatEndsSoonAfterACrashStaysDownUnlessRevived) {
  for (const bool revives : {false, true}) {
    const Healed all = healed(
        kEndsAll, revives ? std::vector<std::string>{"--revive"} : std::vector<std::string>{});
    kill(all.stand_in, SIGKILL);
    std::this_thread::sleep_for(200ms);
    all.launcher->signal(SIGTERM);
    if (revives) {
      EXPECT_TRUE(all.culprit->prints("b_silent resolved by b_redeploy")) << all.culprit->output();
    } else {
      EXPECT_TRUE(all.culprit->prints("after a crashed; a person may have ended it"))
          << all.culprit->output();
      std::this_thread::sleep_for(3s);
      EXPECT_EQ(pid_in(all.culprit->output(), "b"), all.other) << all.culprit->output();
    }
    all.culprit->signal(SIGTERM);
    all.culprit->wait();
    said_by({"end-started"});
    EXPECT_TRUE(goes(pid_in(all.culprit->output(), "a"))) << all.culprit->output();
    EXPECT_TRUE(goes(pid_in(all.culprit->output(), "b"))) << all.culprit->output();
    std::filesystem::remove_all(world.folder() / "state");
  }
}

TEST_F(EndsHealed, ALauncherThatCrashesLeavesItsNodesAndTheStandInRunning) {
  const Healed all = healed(kEndsAll);
  std::this_thread::sleep_for(2s);
  all.launcher->signal(SIGKILL);
  std::this_thread::sleep_for(4s);
  EXPECT_FALSE(is_gone(all.stand_in)) << all.culprit->output();
  EXPECT_FALSE(is_gone(all.other)) << all.culprit->output();
  EXPECT_THAT(all.culprit->output(), Not(HasSubstr("stay")));
  kill(all.other, SIGKILL);
  EXPECT_TRUE(all.culprit->prints("b_silent resolved by b_redeploy")) << all.culprit->output();
  for (const char* name : {"a", "b"}) kill(pid_in(all.culprit->output(), name), SIGKILL);
}

// A person ends the launch, and gives one node another name.
TEST_F(EndsHealed, WhatIsRenamedInTheFileStaysDownNoMore) {
  const std::string rules = rule("a", "alive(a) == false") + rule("b", "alive(b) == false");
  std::string renamed = rules;
  renamed.replace(renamed.find("NODE /a "), 8, "NODE /z ");
  TestProgram launcher(
      world, {"sh", "-c",
              node("a") + " & all=$!; " + node("b") + " & all=\"$all $!\"; trap '" + kEndsAll +
                  "' TERM; while :; do sleep 0.1; done"});
  const auto culprit = start(rules);
  for (const char* name : {"a", "b"})
    ASSERT_TRUE(culprit->prints(std::string(name) + " is there (process ")) << culprit->output();
  ASSERT_TRUE(culprit->prints("watching")) << culprit->output();
  std::this_thread::sleep_for(1s);
  launcher.signal(SIGTERM);
  ASSERT_TRUE(culprit->prints("a and b stay down")) << culprit->output();
  world.write("ends.rules", renamed);
  culprit->signal(SIGHUP);
  ASSERT_TRUE(culprit->prints("is reloaded")) << culprit->output();
  ASSERT_TRUE(culprit->prints("a was never seen")) << culprit->output();
  const std::string status = said_by({"status"});
  EXPECT_THAT(status, Not(HasSubstr("Stays down: a")));
  EXPECT_THAT(status, HasSubstr("Stays down: b: a person ended the launch of b"));
  culprit->signal(SIGTERM);
  culprit->wait();
  const auto next = start(renamed);
  ASSERT_TRUE(next->prints("a was never seen")) << next->output();
  EXPECT_THAT(said_by({"status"}), Not(HasSubstr("Stays down: a")));
}

// One node of a launch that goes on is not the launch.
TEST_F(EndsHealed, ANodeThatAPersonEndsAloneIsBroughtBackIntoItsLaunch) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Healed all = healed(kEndsAll);
    kill(all.other, signal);
    EXPECT_TRUE(all.culprit->prints("b_silent resolved by b_redeploy")) << all.culprit->output();
    const int second = pid_in(all.culprit->output(), "b");
    std::this_thread::sleep_for(2s);
    all.launcher->signal(SIGTERM);
    EXPECT_TRUE(goes(second)) << all.culprit->output();
    EXPECT_TRUE(goes(all.stand_in)) << all.culprit->output();
    all.culprit->signal(SIGTERM);
    all.culprit->wait();
    std::filesystem::remove_all(world.folder() / "state");
  }
}

// The next culprit knows what the one that was killed had started.
TEST_F(EndsHealed, WhatAKilledCulpritHadStartedEndsWithItsLaunchAllTheSame) {
  for (const bool is_next_there_first : {true, false}) {
    const Healed all = healed(kEndsAll);
    all.culprit->signal(SIGKILL);
    all.culprit->wait();
    std::unique_ptr<TestProgram> next;
    const auto begin = [&] {
      next = start(all.rules);
      EXPECT_TRUE(next->prints("watching")) << next->output();
    };
    if (is_next_there_first) begin();
    std::this_thread::sleep_for(2s);
    EXPECT_FALSE(is_gone(all.stand_in));
    all.launcher->signal(SIGTERM);
    EXPECT_TRUE(goes(all.other));
    all.launcher->wait();
    if (!is_next_there_first) begin();
    EXPECT_TRUE(goes(all.stand_in)) << next->output();
    std::this_thread::sleep_for(3s);
    EXPECT_THAT(pid_in(next->output(), "a"), AnyOf(0, all.stand_in)) << next->output();
    EXPECT_THAT(pid_in(next->output(), "b"), AnyOf(0, all.other)) << next->output();
    next->signal(SIGTERM);
    next->wait();
    std::filesystem::remove_all(world.folder() / "state");
  }
}

// culprit is one of the launch, and ends with it.
TEST_F(EndsHealed, ACulpritOfTheSameLaunchEndsWhatStandsInForOthersOfIt) {
  for (const bool ends_whole_launch : {true, false}) {
    std::string rules;
    std::string launch;
    for (const char* name : {"a", "b"}) {
      rules += rule(name, std::string("alive(") + name + ") == false");
      launch += node(name) + " & all=\"$all $!\"; ";
    }
    launch += (own_folder() / "culprit").string() + " run " + world.write("ends.rules", rules) +
              " --state-dir " + (world.folder() / "state").string() +
              " --quiet 0 --settle 0.5 & culprit=$!; ";
    TestProgram launcher(
        world, {"sh", "-c",
                launch + "trap 'for p in $all $culprit; do kill $p; done; wait; exit' TERM; "
                         "trap 'kill $culprit' HUP; while :; do sleep 0.1; done"});
    for (const char* name : {"a", "b"})
      ASSERT_TRUE(launcher.prints(std::string(name) + " is there (process ")) << launcher.output();
    std::this_thread::sleep_for(1s);
    const int other = pid_in(launcher.output(), "b");
    kill(pid_in(launcher.output(), "a"), SIGKILL);
    ASSERT_TRUE(launcher.prints("a_silent resolved by a_redeploy")) << launcher.output();
    const int stand_in = pid_in(launcher.output(), "a");
    std::this_thread::sleep_for(2s);
    // A culprit that is ended alone leaves the robot as it is.
    launcher.signal(ends_whole_launch ? SIGTERM : SIGHUP);
    if (ends_whole_launch) {
      EXPECT_TRUE(goes(other));
      EXPECT_TRUE(goes(stand_in)) << launcher.output();
    } else {
      EXPECT_TRUE(launcher.prints("culprit end-started ends them")) << launcher.output();
      EXPECT_FALSE(is_gone(stand_in));
      said_by({"end-started"});
      EXPECT_TRUE(goes(stand_in));
      launcher.signal(SIGTERM);
      EXPECT_TRUE(goes(other));
    }
    std::filesystem::remove_all(world.folder() / "state");
  }
}

TEST_F(EndsHealed, WhatRunsOnIsNamedAtTheEndAndEndedOnRequest) {
  const Healed all = healed(kEndsAll);
  all.culprit->signal(SIGTERM);
  all.culprit->wait();
  const std::string process = "a (process " + std::to_string(all.stand_in);
  EXPECT_THAT(all.culprit->output(), HasSubstr("culprit end-started ends them"));
  EXPECT_THAT(all.culprit->output(), HasSubstr(process));
  EXPECT_FALSE(is_gone(all.stand_in));
  EXPECT_THAT(said_by({"end-started"}), HasSubstr("ends " + process));
  EXPECT_TRUE(is_gone(all.stand_in));
  EXPECT_FALSE(is_gone(all.other));
  EXPECT_THAT(said_by({"end-started"}), HasSubstr("No process runs that a culprit started"));
  all.launcher->signal(SIGTERM);
  EXPECT_TRUE(goes(all.other));
}

// Its component may be down: the robot does not go on as it was.
TEST_F(EndsHealed, ACulpritThatEndsInTheMiddleOfARepairSaysSo) {
  const TestProgram first(world, {"ros2_peer_node", domain, "/a"});
  std::string rules = rule("a", "alive(a) == false");
  rules.replace(rules.find(node("a")), node("a").size(), "sleep 600");  // never makes the node
  const auto culprit = start(rules);
  ASSERT_TRUE(culprit->prints("a is there (process ")) << culprit->output();
  std::this_thread::sleep_for(1s);
  kill(pid_in(culprit->output(), "a"), SIGKILL);
  for (const Time end = later(live_now(), TestProgram::kPatience);
       live_now() < end && said_by({"status"}).find("Started by culprit: a") == std::string::npos;)
    std::this_thread::sleep_for(50ms);
  culprit->signal(SIGTERM);
  culprit->wait();
  EXPECT_THAT(culprit->output(), HasSubstr("culprit: it ends in the middle of a_redeploy for "
                                           "a_silent; the next `culprit run` finishes it"));
  said_by({"end-started"});
}

// `--launch` is a person's wish, too, and the later one.
TEST_F(EndsHealed, WhatAPersonEndedAndLaunchesAgainStaysUp) {
  const std::string rules = rule("a", "alive(a) == false") + rule("b", "alive(b) == false");
  auto first = start(rules, {"--launch"});
  for (const char* name : {"a", "b"})
    ASSERT_TRUE(first->prints(std::string(name) + " is there (process ")) << first->output();
  for (const Time end = later(live_now(), TestProgram::kPatience);
       live_now() < end && said_by({"status"}).find("Started by culprit: b") == std::string::npos;)
    std::this_thread::sleep_for(50ms);
  said_by({"end-started"});
  ASSERT_TRUE(first->prints("a and b stay down")) << first->output();
  for (const char* name : {"a", "b"}) ASSERT_TRUE(goes(pid_in(first->output(), name)));
  first->signal(SIGTERM);
  first->wait();
  const auto next = start(rules, {"--launch"});
  for (const char* name : {"a", "b"})
    ASSERT_TRUE(next->prints(std::string(name) + " is there (process ")) << next->output();
  std::this_thread::sleep_for(3s);  // that nothing happens takes time
  for (const char* name : {"a", "b"})
    EXPECT_FALSE(is_gone(pid_in(next->output(), name))) << next->output();
  EXPECT_THAT(said_by({"status"}), Not(HasSubstr("Stays down")));
  said_by({"end-started"});
  for (const char* name : {"a", "b"}) EXPECT_TRUE(goes(pid_in(next->output(), name)));
}

}  // namespace
}  // namespace culprit::cli
