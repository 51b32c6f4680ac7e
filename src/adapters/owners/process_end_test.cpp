#include "owners/process_end.h"

#include <csignal>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "owners/file_descriptor.h"

namespace culprit::owners {
namespace {

// Before its parent received it, and, where the kernel keeps it, after that.
TEST(ProcessEnd, OfSomebodyElsesProcessIsToldByTheKernel) {
  const int pid = fork();
  if (pid == 0) {
    while (true) pause();
  }
  const FileDescriptor held(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  kill(pid, SIGABRT);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT);
  const ProcessEnd unheard = end_of(pid, held.get());
  EXPECT_EQ(unheard.remark, "killed by signal 6");
  EXPECT_EQ(unheard.cause, Cause::kFault);
  waitpid(pid, nullptr, 0);
  const ProcessEnd heard = end_of(pid, held.get());
  EXPECT_TRUE(heard.remark == "killed by signal 6" || heard.cause == Cause::kUnknown)
      << heard.remark;
}

TEST(ProcessEnd, IsAWishIfAPersonOrALauncherAsksSo) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    EXPECT_EQ(killed(signal).cause, Cause::kWish) << signal;
    EXPECT_EQ(exited(128 + signal).cause, Cause::kWish) << signal;
    EXPECT_EQ(exited(256 - signal).cause, Cause::kWish) << signal;
  }
  EXPECT_EQ(exited(0).cause, Cause::kWish);
  for (const int signal : {SIGKILL, SIGSEGV, SIGABRT, SIGBUS})
    EXPECT_EQ(killed(signal).cause, Cause::kFault) << signal;
  for (const int code : {1, 2, 134, 137, 139, 247})
    EXPECT_EQ(exited(code).cause, Cause::kFault) << code;
}

}  // namespace
}  // namespace culprit::owners
