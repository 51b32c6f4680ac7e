#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/proc.h"
#include "owners/supervisor.h"
#include "owners/test_process.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// A process whose core dump takes a moment.
int with_much_memory(const test::TestFolder& folder) {
  const int pid = fork();
  if (pid != 0) return pid;
  constexpr std::size_t kBytes = std::size_t{384} << 20;
  const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
  if (chdir(folder.path().c_str()) != 0 || setrlimit(RLIMIT_CORE, &all) != 0) _exit(1);
  void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) _exit(1);
  std::memset(memory, 1, kBytes);
  close(creat("ready", 0600));
  while (true) pause();
}

// Its launcher started another one meanwhile.
TEST(Supervisor, AStopThatIsMeantForAProcessNeverReachesItsSuccessor) {
  Supervised c("sleep 1000");
  const int first = c.start();
  kill(first, SIGKILL);
  c.state(ProcessState::kGone);
  const int second = c.start();
  c.supervisor->stop({9}, ComponentId(0), first, Ending::kToStartAgain);
  EXPECT_EQ(c.reply_to({9}).outcome, Outcome::kDone);
  EXPECT_EQ(kill(second, 0), 0);
  EXPECT_NE(state_letter(second).value_or('Z'), 'Z');
}

TEST(Supervisor, KillsWhatDoesNotListen) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  const Time begin = live_now();
  c.stop();
  EXPECT_FALSE(exists(pid));
  EXPECT_GE(live_now() - begin, Supervisor::kPolite + Supervisor::kFirm) << "it had its chances";
}

TEST(Supervisor, KillsWhatHangsSoon) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9") << "not by SIGTERM";
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, KillsSoonWhatIsKnownToHangOnlyWhileItIsEnded) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kToStartAgain);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9") << "not by SIGTERM";
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, KillsAStoppedProcessAtOnce) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  kill(pid, SIGSTOP);
  EXPECT_EQ(c.state(ProcessState::kStopped).pid, pid);
  c.stop();
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, AnswersAllThatWaitForOneEnd) {
  Supervised c("sleep 1000");
  c.start();
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kDone);
}

TEST(Supervisor, WaitsForTheCoreDumpOfAProcessThatCrashed) {
  std::string pattern;
  std::ifstream("/proc/sys/kernel/core_pattern") >> pattern;
  if (pattern != "core") GTEST_SKIP() << "this machine writes core dumps elsewhere";
  const test::TestFolder folder;
  const int pid = with_much_memory(folder);
  while (!std::filesystem::exists(folder / "ready") && is_alive(pid))
    std::this_thread::sleep_for(10ms);
  Supervised c("sleep 1000");
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  kill(pid, SIGSEGV);
  while (!core_dump_of(pid)) {
    if (!is_alive(pid)) GTEST_SKIP() << "this machine writes no core dump, or in no time";
  }
  c.supervisor->stop({7}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(c.missing(),
            "the core dump of its crashed process " + std::to_string(pid) + " is not complete");
  EXPECT_EQ(c.reply_to({7}).outcome, Outcome::kRefused);
  c.supervisor->stop({8}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  c.nothing_missing();
  EXPECT_EQ(c.reply_to({8}).outcome, Outcome::kDone);
  std::uintmax_t dumped = 0;
  for (const auto& each : std::filesystem::directory_iterator(folder.path()))
    dumped = std::max(dumped, each.file_size());
  EXPECT_GE(dumped, std::uintmax_t{384} << 20) << "it is cut";
}

TEST(Supervisor, WaitsForTheCoreDumpOfAChildUntilItIsCompleteThoughItsWrapperRunsOn) {
  std::string pattern;
  std::ifstream("/proc/sys/kernel/core_pattern") >> pattern;
  if (pattern != "core") GTEST_SKIP() << "this machine writes core dumps elsewhere";
  const test::TestFolder folder;
  const std::string script = (folder / "node.py").native();
  std::ofstream(script) << "import os, resource, time\n"
                           "os.chdir('"
                        << folder.path().native()
                        << "')\n"
                           "resource.setrlimit(resource.RLIMIT_CORE, (-1, -1))\n"
                           "memory = bytearray(b'1') * (384 << 20)\n"
                           "open('pid', 'w').write(str(os.getpid()))\n"
                           "os.rename('pid', 'ready')\n"
                           "time.sleep(1000)\n";
  Supervised c("sh -c 'python3 " + script + "; sleep 1000'");
  const int wrapper = c.start();
  for (const Time end = later(live_now(), 20s); !std::filesystem::exists(folder / "ready");) {
    if (live_now() > end) GTEST_SKIP() << "this machine limits core dumps";
    std::this_thread::sleep_for(10ms);
  }
  int pid = 0;
  std::ifstream(folder / "ready") >> pid;
  kill(pid, SIGSEGV);
  while (!core_dump_of(pid)) {
    if (!is_alive(pid)) GTEST_SKIP() << "this machine writes no core dump, or in no time";
  }
  c.supervisor->stop({7}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  c.missing();
  EXPECT_EQ(c.reply_to({7}).outcome, Outcome::kRefused);
  const Time since = live_now();
  c.nothing_missing();
  EXPECT_LT(live_now() - since, Supervisor::kDump / 2);
  EXPECT_TRUE(is_alive(wrapper));
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
}

// A person looks at it; but what is to stop for good does.
TEST(Supervisor, DoesNotReplaceWhatADebuggerHolds) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  if (ptrace(PTRACE_SEIZE, pid, nullptr, nullptr) != 0)
    GTEST_SKIP() << "no process may be traced here";
  ptrace(PTRACE_INTERRUPT, pid, nullptr, nullptr);
  for (const Time end = live_now() + 20s; state_letter(pid) != 't' && live_now() < end;)
    std::this_thread::sleep_for(1ms);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  const Reply refused = c.reply_to({3});
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_NE(refused.text.find("is not replaced while a debugger holds it"), std::string::npos)
      << refused.text;
  EXPECT_TRUE(exists(pid));
  c.supervisor->stop({4}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.reply_to({4}).outcome, Outcome::kDone);
}

TEST(Supervisor, EndsWhatTheProcessHadStarted) {
  Supervised c("sh -c 'sleep 1000 & echo child $!; wait'");
  c.start();
  const std::string log = c.log_when("child ");
  const int child = std::stoi(log.substr(log.find("child ") + 6));
  EXPECT_TRUE(exists(child));
  c.stop();
  for (int tries = 0; tries < 1000 && exists(child); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(exists(child));
}

// It leads a session of its own, and holds the device that the successor needs.
TEST(Supervisor, EndsWhatTheProcessHadStartedInASessionOfItsOwn) {
  const std::string robot = "test/tree/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid sleep 1000 & echo daemon $!; wait'", robot);
  const auto daemon_of = [&](std::size_t which) {
    std::string log;
    std::size_t at = 0;
    for (int tries = 0; tries < 1000; ++tries) {
      log = c.log_when("daemon ");
      at = std::string::npos;
      for (std::size_t i = 0, from = 0; i <= which; ++i, from = at + 1)
        at = log.find("daemon ", from);
      if (at != std::string::npos) break;
      std::this_thread::sleep_for(10ms);
    }
    return at == std::string::npos ? 0 : std::stoi(log.substr(at + 7));
  };
  const auto ends = [](int pid) {
    for (int tries = 0; tries < 1000 && is_alive(pid); ++tries) std::this_thread::sleep_for(10ms);
    return !is_alive(pid);
  };
  const int first = c.start();
  const int daemon = daemon_of(0);
  ASSERT_TRUE(becomes(daemon, "sleep"));
  c.stop();
  EXPECT_FALSE(exists(first));
  EXPECT_TRUE(ends(daemon));

  const int second = c.start();
  const int another = daemon_of(1);
  ASSERT_TRUE(becomes(another, "sleep"));
  kill(second, SIGKILL);  // by itself, as a node crashes
  c.state(ProcessState::kGone);
  EXPECT_TRUE(ends(another));
}

TEST(Supervisor, ADeviceThatSuchAChildHeldIsFreeForTheSuccessor) {
  const std::string robot = "test/device/" + std::to_string(getpid());
  const test::TestFolder folder;
  Supervised c("sh -c 'exec 9>" + (folder / "device").string() +
                   "; flock -n 9 || { echo busy; exit 7; }; setsid sleep 1000 & echo mine; wait'",
               robot);
  c.start();
  c.log_when("mine");
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  c.start();
  EXPECT_EQ(c.log_when("mine\nmine").find("busy"), std::string::npos);
}

// As above, and it forgets whose it is.
TEST(Supervisor, EndsWhatHasClearedItsEnvironment) {
  const std::string robot = "test/cleared/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid env -i sleep 1000 & echo daemon $!; wait'", robot);
  c.start();
  const std::string log = c.log_when("daemon ");
  const int daemon = std::stoi(log.substr(log.find("daemon ") + 7));
  ASSERT_TRUE(becomes(daemon, "sleep"));
  c.stop();
  for (int tries = 0; tries < 1000 && is_alive(daemon); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(daemon));
}

// A launch command may make a daemon and end: then that is the node.
TEST(Supervisor, WhatAProcessLeftThatEndedByItselfGoesOnUntilTheComponentIsStarted) {
  const std::string robot = "test/daemon/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid sleep 1000 & echo daemon $!; sleep 0.2'", robot);
  c.start();
  const std::string log = c.log_when("daemon ");
  const int daemon = std::stoi(log.substr(log.find("daemon ") + 7));
  c.state(ProcessState::kGone);
  EXPECT_TRUE(is_alive(daemon));
  EXPECT_NE(c.start(), daemon) << "the component runs no more, so it can be started";
  for (int tries = 0; tries < 1000 && is_alive(daemon); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(daemon)) << "beside its successor";
}

}  // namespace
}  // namespace culprit::owners
