#include "owners/proc.h"

#include <csignal>
#include <fstream>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/test_supervised.h"
#include "owners/watched_process.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

TEST(Proc, AWaitingProcessDoesNotWork) {
  using namespace std::chrono_literals;
  const Work before{1s, 10 << 20};
  EXPECT_FALSE((Work{1s + 49ms, 10 << 20}.is_more_than(before)));
  EXPECT_FALSE((Work{900ms, 5 << 20}.is_more_than(before))) << "one of its processes has exited";
  EXPECT_TRUE((Work{1s + 50ms, 10 << 20}.is_more_than(before)));
  EXPECT_TRUE((Work{1s, 11 << 20}.is_more_than(before)));
}

TEST(Proc, APythonNodeIsItsScript) {
  const test::TestFolder own;
  const auto script = own / "script";
  std::ofstream(script) << "sleep 1000; true\n";
  const int pid = start_by_others("exec bash -e " + script.string());
  ASSERT_TRUE(becomes(pid, "bash"));
  EXPECT_EQ(identity_of(pid)->script, script.string());
  EXPECT_EQ(identity_of(pid)->user, geteuid());
  kill(-pid, SIGKILL);
}

TEST(WatchedProcess, OneThatADebuggerHoldsIsNotStopped) {
  const int pid = fork();
  ASSERT_GE(pid, 0);
  if (pid == 0) {
    while (true) pause();
  }
  const auto process = WatchedProcess::watch(pid, Relation::kChild);
  ASSERT_TRUE(process) << process.error();
  const bool may_trace = ptrace(PTRACE_SEIZE, pid, nullptr, nullptr) == 0;
  if (may_trace) {
    ptrace(PTRACE_INTERRUPT, pid, nullptr, nullptr);
    for (const Time end = live_now() + 20s; state_letter(pid) != 't' && live_now() < end;)
      std::this_thread::sleep_for(1ms);
    EXPECT_EQ(state_letter(pid), 't');
    EXPECT_EQ(process->state(), ProcessState::kRunning);
  }
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  if (!may_trace) GTEST_SKIP() << "no process may be traced here";
}

}  // namespace
}  // namespace culprit::owners
