#include "owners/process_tree.h"

#include <csignal>
#include <unistd.h>

#include <gtest/gtest.h>

#include "owners/spawn.h"
#include "owners/test_process.h"

namespace culprit::owners {
namespace {

// A number that was reused has another start.
TEST(ProcessTree, HoldsTheProcessThatIsMeantAndNoOtherOfItsNumber) {
  Program program;
  program.arguments = {"sleep", "60"};
  program.log = "/dev/null";
  const auto pid = spawn(program);
  ASSERT_TRUE(pid) << pid.error();
  const auto start = start_ticks_of(*pid);
  ASSERT_TRUE(start);
  EXPECT_FALSE(hold(*pid, *start + 1));
  EXPECT_FALSE(hold(*pid, 0));
  const FileDescriptor held = hold(*pid, *start);
  ASSERT_TRUE(held);
  EXPECT_TRUE(is_alive(*pid));
  send_signal(held, SIGKILL);
  while (is_alive(*pid)) usleep(1000);
}

// A descriptor that was never opened names no process.
TEST(ProcessTreeDeathTest, SignalsAProcessThatIsHeldOnly) {
  EXPECT_DEATH(send_signal(FileDescriptor(), SIGTERM), "'process' does not hold");
}

}  // namespace
}  // namespace culprit::owners
