#include "owners/freezer.h"

#include <chrono>
#include <csignal>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "owners/test_control_group.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

bool becomes(const Freezer& freezer, bool is_frozen) {
  for (int tries = 0; tries < 1000 && freezer.is_frozen() != is_frozen; ++tries)
    std::this_thread::sleep_for(10ms);
  return freezer.is_frozen() == is_frozen;
}

TEST(Freezer, ShowsThatAControlGroupWasFrozenAndThawed) {
  bool is_any_there = false;
  for (const auto version : {TestControlGroup::Version::k1, TestControlGroup::Version::k2}) {
    const TestControlGroup group(version);
    if (!group.is_there()) continue;
    is_any_there = true;
    const int pid = fork();
    if (pid == 0) {
      while (true) pause();
    }
    group.take(pid);
    const Freezer freezer(pid);
    EXPECT_FALSE(freezer.is_frozen());
    group.freeze();
    EXPECT_TRUE(becomes(freezer, true));
    group.freeze(false);
    EXPECT_TRUE(becomes(freezer, false));
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  if (!is_any_there) GTEST_SKIP() << "this machine lets nobody make a control group";
}

TEST(Freezer, IsOfNoGroupIfThereIsNoSuchProcess) { EXPECT_FALSE(Freezer(1 << 30).is_frozen()); }

}  // namespace
}  // namespace culprit::owners
