#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/launch_note.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/started_processes.h"
#include "owners/supervisor.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

TEST(Supervisor, LeavesWhatIsRespawnedToItsLauncher) {
  const Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int first = launcher.child();
  c.supervisor->adopt(ComponentId(0), first, live_now());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused) << "it would come back";
  EXPECT_TRUE(exists(first));
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0) << "a second one was started";
  EXPECT_NE(launcher.child(first), 0);
}

TEST(Supervisor, TakesOverFromALauncherThatHasEnded) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"}, "7/test");
  const int orphan = launcher.child();
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  launcher.end();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  const int ours = c.start();
  EXPECT_NE(ours, 0);
  c.supervise();  // another culprit knows it by its mark
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_NE(c.start(), 0) << "there is no launcher any more to wait for";
}

TEST(Supervisor, TakesOverFromALauncherThatEndedBeforeItCame) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int orphan = launcher.child();
  launcher.end();
  while (parent_of(orphan) == getpid()) std::this_thread::sleep_for(1ms);
  if (parent_of(orphan) != 1) {
    kill(orphan, SIGKILL);
    GTEST_SKIP() << "orphans of this machine do not go to init";
  }
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_NE(c.start(), 0) << "there is no launcher any more to wait for";
}

// Its launcher is unknown, and so is whether that launcher will start it again.
TEST(Supervisor, WaitsForTheProgramThatInitStartedItFor) {
  int pid = 0;
  int pipe_of[2];
  ASSERT_EQ(pipe2(pipe_of, O_CLOEXEC), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    if (fork() == 0) {
      const int self = setsid();  // as what init starts is
      (void)!write(pipe_of[1], &self, sizeof self);
      execl("/bin/sleep", "sleep", "1000", nullptr);
    }
    _exit(0);
  }
  ASSERT_EQ(read(pipe_of[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  waitpid(parent, nullptr, 0);
  close(pipe_of[0]);
  close(pipe_of[1]);
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0);
}

// It ends with its program, and its launcher starts it again.
TEST(Supervisor, TakesRos2RunForNoLauncher) {
  const test::TestFolder folder;
  const std::string tool = folder.path() / "ros2";
  std::ofstream(tool) << "sleep 1000; true\n";
  const Respawning launcher("sh " + tool + " run package program");
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int first = launcher.child();
  c.supervisor->adopt(ComponentId(0), first, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0) << "a second one was started";
  EXPECT_NE(launcher.child(first), 0);
}

// As ros2 launch does where the launch file says on_exit=Shutdown().
TEST(Supervisor, TellsHowALauncherEndedAndWhetherItRanOthers) {
  for (const bool runs_others : {false, true}) {
    Supervised c("sleep 1000");
    const std::string others = runs_others ? "sleep 30 & " : "";
    const auto launcher =
        spawn({{"sh", "-c", others + "sleep 1000 & wait $!; exit 0"}, {}, "/dev/null"});
    ASSERT_TRUE(launcher);
    int child = 0;
    while (child == 0) {
      for (const Relative& each : descendants_of(*launcher)) {
        std::ifstream command("/proc/" + std::to_string(each.pid) + "/cmdline", std::ios::binary);
        std::string text(std::istreambuf_iterator<char>(command), {});
        if (text.find("1000") != std::string::npos && text.starts_with("sleep")) child = each.pid;
      }
    }
    c.supervisor->adopt(ComponentId(0), child, live_now());
    EXPECT_FALSE(c.launcher().has_ended);
    kill(child, SIGKILL);
    const LauncherSeen seen = c.launcher();
    EXPECT_TRUE(seen.has_ended);
    EXPECT_FALSE(seen.has_crashed);
    EXPECT_EQ(seen.ran_others, runs_others);
    waitpid(*launcher, nullptr, 0);
  }
}

// Two simulated robots of one user have the same state folder.
TEST(Supervisor, RobotsThatShareAFolderNoteTheirLaunchersApart) {
  Supervised one("sleep 1000", "0/one");
  Supervised two("sleep 1000", "0/two");
  ASSERT_EQ(one.folder(), two.folder());
  std::vector<int> launchers;
  for (Supervised* each : {&one, &two}) {
    const auto launcher = spawn({{"sh", "-c", "sleep 1000 & wait"}, {}, "/dev/null"});
    ASSERT_TRUE(launcher);
    launchers.push_back(*launcher);
    each->supervisor->adopt(ComponentId(0), a_child_of(*launcher), live_now());
  }
  EXPECT_EQ(noted_launch(one.folder(), "0/one/c").launcher, launchers[0]);
  EXPECT_EQ(noted_launch(two.folder(), "0/two/c").launcher, launchers[1]);
  for (const int launcher : launchers) {
    kill(a_child_of(launcher), SIGKILL);
    kill(launcher, SIGKILL);
    waitpid(launcher, nullptr, 0);
  }
}

// A process that culprit starts while the launcher runs stands in for the launch, and its mark says
// so.
TEST(Supervisor, WhatItStartsWhileTheLauncherRunsStandsInForTheLaunch) {
  Supervised c("sleep 1000", "0/stand_in");
  const auto launcher = spawn({{"sh", "-c", "sleep 1000 & sleep 1001 & wait"}, {}, "/dev/null"});
  ASSERT_TRUE(launcher);
  const int child = a_child_of(*launcher);
  c.supervisor->adopt(ComponentId(0), child, live_now());
  kill(child, SIGKILL);
  c.state(ProcessState::kGone);
  const int pid = c.start();
  EXPECT_EQ(place_held_by(pid).launcher, *launcher);
  EXPECT_TRUE(place_held_by(pid).goes_on);
  // The next culprit knows it by its mark.
  c.supervise();
  const StartedHere again = c.started();
  EXPECT_EQ(again.pid, pid);
  EXPECT_EQ(again.launcher, *launcher);
  EXPECT_FALSE(c.launcher().has_ended);
  const auto listed = started_processes("0/stand_in");
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].component, "c");
  EXPECT_EQ(listed[0].launcher, *launcher);
  kill(*launcher, SIGKILL);
  waitpid(*launcher, nullptr, 0);
  const LauncherSeen ended = c.launcher();
  EXPECT_TRUE(ended.has_ended);
  EXPECT_TRUE(ended.has_crashed);
  EXPECT_FALSE(place_held_by(pid).goes_on);
  // A culprit that starts after the end receives it at once.
  c.supervise();
  EXPECT_TRUE(c.launcher().has_ended);
  // Unless another one had found that the process goes on.
  c.supervisor->stands_in_for_none(ComponentId(0));
  c.supervise();
  EXPECT_EQ(c.started().launcher, 0);
  c.supervisor->end_with_launch(ComponentId(0));
  EXPECT_EQ(c.state(ProcessState::kGone).cause, Cause::kWish);
  EXPECT_TRUE(started_processes("0/stand_in").empty());
}

TEST(Supervisor, ReportsTheStarterOfAProcessAndItsEnd) {
  Supervised c("sleep 1000");
  const auto launcher = spawn({{"sh", "-c", "sleep 1000 & wait"}, {}, "/dev/null"});
  ASSERT_TRUE(launcher);
  const int child = a_child_of(*launcher);
  c.supervisor->adopt(ComponentId(0), child, live_now());
  EXPECT_EQ(c.launcher().pid, *launcher);
  // Ctrl-Z stops both.
  kill(*launcher, SIGSTOP);
  kill(child, SIGSTOP);
  EXPECT_EQ(c.state(ProcessState::kStopped).cause, Cause::kWish);
  kill(child, SIGCONT);
  kill(*launcher, SIGKILL);
  waitpid(*launcher, nullptr, 0);
  const LauncherSeen seen = c.launcher();
  EXPECT_EQ(seen.pid, *launcher);
  EXPECT_TRUE(seen.has_ended);
  kill(child, SIGKILL);
  EXPECT_NE(c.state(ProcessState::kGone).cause, Cause::kWish);
}

TEST(Supervisor, EndsNoOrphanThatNobodyWouldStartAgain) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"RESPAWNED"});
  const int orphan = launcher.child();
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  launcher.end();
  const Reply reply = c.stop_to_start_again();
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_NE(reply.text.find("launcher of c has exited"), std::string::npos) << reply.text;
  EXPECT_TRUE(exists(orphan));
  kill(orphan, SIGKILL);
}

TEST(Supervisor, StartsNothingBesideALauncherThatItDoesNotKnow) {
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  EXPECT_EQ(c.start(), 0);
}

// With no culprit there any more.
TEST(StartedProcesses, AreEndedAsALaunchEndsThem) {
  const test::TestFolder folder;
  const std::string script = folder.path() / "stubborn";
  std::ofstream(script) << "trap '' INT; sleep 1000 & while :; do wait; done\n";
  Supervised c("sh " + script, "0/left_behind");
  const int pid = c.start();
  const auto found = started_processes("0/left_behind");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pid, pid);
  EXPECT_EQ(found[0].launcher, 0);
  auto another = found;
  another[0].since -= 10s;  // a process that had the number before
  EXPECT_TRUE(end_processes(another).empty());
  EXPECT_EQ(started_processes("0/left_behind").size(), 1u);
  EXPECT_TRUE(end_processes(found).empty());
  EXPECT_TRUE(started_processes("0/left_behind").empty());
}

}  // namespace
}  // namespace culprit::owners
