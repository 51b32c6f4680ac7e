#include "link/processor_time.h"

#include <atomic>
#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

// A process that is killed at the end.
class Child {
 public:
  explicit Child(bool works) : pid_(fork()) {
    if (pid_ != 0) return;
    for (std::atomic<int> rounds = 0;; ++rounds) {
      if (!works) pause();
    }
  }
  ~Child() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  bool works_within(Duration time) const {
    const auto before = look_at_processor_time(pid_);
    usleep(static_cast<useconds_t>(time / std::chrono::microseconds(1)));
    const auto after = look_at_processor_time(pid_);
    return before && after && was_at_work(*before, *after);
  }

 private:
  const pid_t pid_;
};

TEST(ProcessorTime, TellsWhichProcessesWorkOrWouldWork) {
  if (!processor_time_wanted(getpid())) GTEST_SKIP() << "the kernel does not show it";
  EXPECT_TRUE(Child(true).works_within(200ms)) << "however little of the processor it gets";
  EXPECT_FALSE(Child(false).works_within(200ms));
}

TEST(ProcessorTime, OfNoProcessIsNotKnown) {
  EXPECT_FALSE(look_at_processor_time(0));
  EXPECT_FALSE(was_at_work({7, Time(1s), 1s}, {8, Time(2s), 2s})) << "another process";
}

}  // namespace
}  // namespace culprit::link
