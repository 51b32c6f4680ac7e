#include <csignal>
#include <fstream>
#include <poll.h>
#include <set>
#include <string>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/supervisor.h"
#include "owners/test_process.h"
#include "owners/test_supervised.h"
#include "owners/watched_process.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

TEST(Supervisor, AdoptsAndEndsAProcessThatWasThere) {
  Supervised c("sleep 1000");
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null"});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt(ComponentId(0), *foreign, live_now());
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, *foreign);
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign)) << "what is a child of this program is reaped, too";
}

// One that a launch file started, too.
TEST(Supervisor, WithdrawsWhatItStartedAndNothingElse) {
  for (const bool is_of_earlier_one : {false, true}) {
    Supervised one("sh -c 'sleep 300 & wait'", "test/" + std::to_string(getpid()) + "/withdrawn");
    const int ours = one.start();
    if (is_of_earlier_one) {
      one.supervise();
      EXPECT_EQ(one.state(ProcessState::kRunning).pid, ours);
    }
    const Respawning launcher;
    const int other = launcher.child();
    one.supervisor->adopt(ComponentId(0), other, live_now());
    std::set<int> started;
    while (started.size() < 2) started = one.supervisor->started(ComponentId(0));
    EXPECT_TRUE(started.contains(ours));
    EXPECT_FALSE(started.contains(other));
    one.supervisor->withdraw(ComponentId(0));
    EXPECT_TRUE(one.supervisor->started(ComponentId(0)).empty()) << "it is asked once";
    EXPECT_EQ(one.state(ProcessState::kGone).pid, ours);
    EXPECT_TRUE(is_alive(other));
    EXPECT_FALSE(one.supervisor->has_started(ComponentId(0)));
    one.supervisor->withdraw(ComponentId(0));
    std::this_thread::sleep_for(50ms);
    EXPECT_TRUE(is_alive(other));
  }
}

TEST(Supervisor, LeavesItsProcessesRunningWhenItEnds) {
  int pid = 0;
  {
    const RuleSet rules = *check(Source("test.rules", "COMPONENT c LAUNCH \"sleep 1000\"\n")).rules;
    Inbox inbox;
    const test::TestFolder logs;
    Supervisor supervisor(rules, {logs.path(), {}}, inbox);
    supervisor.start({1}, ComponentId(0));
    std::vector<Observation> seen;
    for (const Time end = live_now() + 30s; pid == 0 && live_now() < end;) {
      inbox.take(end, seen);
      for (const Observation& o : seen) {
        if (const auto* process = std::get_if<ProcessSeen>(&o.what)) pid = process->pid;
      }
    }
  }
  ASSERT_NE(pid, 0);
  EXPECT_TRUE(exists(pid));
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

// As after a crash: only the operating system's data are known.
TEST(Supervisor, TakesOverWhatAnotherOneOfTheSameRobotStarted) {
  const std::string robot = "test/" + std::to_string(getpid());
  auto first = std::make_unique<Supervised>("sleep 1000", robot);
  const int pid = first->start();
  kill(pid, SIGSTOP);
  first->state(ProcessState::kStopped);
  first->supervisor.reset();

  Supervised stranger("sleep 1000", robot + "0");
  EXPECT_NE(stranger.start(), pid) << "another robot's component of the same name";
  Supervised second("sleep 1000", robot);
  EXPECT_EQ(second.state(ProcessState::kRunning).pid, pid);
  second.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(second.reply_to({3}).outcome, Outcome::kRefused);
  second.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(second.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
  EXPECT_NE(second.start(), pid);
}

// A component may be a culprit of its own, with components.
TEST(Supervisor, LeavesTheComponentsOfAnotherCulpritAlone) {
  const std::string robot = "test/inner/" + std::to_string(getpid());
  const test::TestFolder folder;
  const std::string script = (folder / "inner.sh").string();
  std::ofstream(script) << "export CULPRIT_COMPONENT=inner/x CULPRIT_PROCESS=$$\nexec sleep 1000\n";
  Supervised c("sh -c 'setsid sh " + script + " & echo inner $!; wait'", robot);
  c.start();
  const std::string log = c.log_when("inner ");
  const int inner = std::stoi(log.substr(log.find("inner ") + 6));
  ASSERT_TRUE(becomes(inner, "sleep"));
  c.stop();
  EXPECT_TRUE(is_alive(inner));
  end(inner);
}

TEST(Supervisor, AdoptsAProcessAgainOnlyIfItIsTheSameOne) {
  Supervised c("sleep 1000");
  const Time before = live_now() - 1s;
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt_again(ComponentId(0), *foreign, before);
  const int started = c.start();
  EXPECT_NE(started, *foreign) << "a reused PID is not adopted";
  c.stop();
  c.supervisor->adopt_again(ComponentId(0), *foreign, live_now());
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
  c.supervisor->stop({4}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({4}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign));
}

// Its node ran on another computer, or in a container.
TEST(Supervisor, AProcessThatWasNeverKnownDidNotEndUnseen) {
  Supervised c("sleep 1000");
  c.supervisor->adopt_again(ComponentId(0), 0, live_now());
  std::vector<Observation> seen;
  c.inbox.take(live_now(), seen);
  EXPECT_TRUE(seen.empty());
}

TEST(Supervisor, AProcessThatBeganLaterIsAnother) {
  Supervised c("sleep 1000");
  const auto stranger = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(stranger);
  c.supervisor->adopt(ComponentId(0), *stranger, live_now() - 1s);
  EXPECT_EQ(c.state(ProcessState::kGone).pid, *stranger)
      << "the former process with its PID has exited";
  c.stop();
  EXPECT_TRUE(exists(*stranger)) << "it is not culprit's to end";
  kill(*stranger, SIGKILL);
  waitpid(*stranger, nullptr, 0);
}

TEST(Supervisor, AProcessWhoseMainThreadEndedRuns) {
  const int pid = fork();
  if (pid == 0) {
    std::thread([] { pause(); }).detach();
    syscall(SYS_exit, 0);  // of this thread alone
  }
  for (int tries = 0; tries < 3000 && state_letter(pid) != 'Z'; ++tries)
    std::this_thread::sleep_for(10ms);
  const auto process = WatchedProcess::watch(pid, Relation::kAdopted);
  ASSERT_TRUE(process);
  EXPECT_EQ(process->state(), ProcessState::kRunning);
  kill(pid, SIGKILL);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT);
  EXPECT_EQ(process->state(), ProcessState::kGone) << "a zombie is no process";
  waitpid(pid, nullptr, 0);
}

TEST(Launch, WhatRunsGoesOnWhetherOrNotAnybodyAsked) {
  const test::TestFolder own;
  const auto log = own / "log";
  int pid = 0;
  {
    const auto launch = Launch::begin({{"sleep", "1000"}, {}, log}, Until::kItRuns);
    ASSERT_TRUE(launch) << launch.error();
    pid = launch->pid();
    pollfd report{launch->descriptor(), POLLIN, 0};
    ASSERT_EQ(poll(&report, 1, 30'000), 1);
  }
  EXPECT_EQ(state_letter(pid).value_or('X') == 'Z', false);
  kill(pid, SIGKILL);
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED), 0) << "it is ours to reap";
}

}  // namespace
}  // namespace culprit::owners
