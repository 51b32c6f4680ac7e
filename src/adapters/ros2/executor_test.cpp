#include "ros2/executor.h"

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/timer.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using Clock = Executor::Clock;

TEST(Executor, RunsTasksInTheOrderOfPosting) {
  Executor executor;
  TaskGroup tasks(executor);
  std::vector<int> ran;
  for (int i = 0; i < 3; ++i) tasks.post([&ran, i] { ran.push_back(i); });
  tasks.post([&executor] { executor.stop(); });
  executor.run();
  EXPECT_THAT(ran, ElementsAre(0, 1, 2));
}

TEST(Executor, RunsTimedTasksInTheOrderOfTheirTimes) {
  Executor executor;
  TaskGroup tasks(executor);
  std::vector<int> ran;
  const auto now = Clock::now();
  tasks.post_at(now + 20ms, [&] { ran.push_back(2); });
  tasks.post_at(now + 30ms, [&] { executor.stop(); });
  tasks.post_at(now + 10ms, [&] { ran.push_back(1); });
  executor.run();
  EXPECT_THAT(ran, ElementsAre(1, 2));
  EXPECT_GE(Clock::now(), now + 30ms);
}

TEST(Executor, WakesForWorkFromAnotherThread) {
  Executor executor;
  TaskGroup tasks(executor);
  std::thread other([&] {
    std::promise<void> ran;
    tasks.post([&] { ran.set_value(); });
    ran.get_future().wait();
    executor.stop();
  });
  executor.run();
  other.join();
}

TEST(Executor, StopsAlsoWhenItWasToldBefore) {
  Executor executor;
  executor.stop();
  executor.run();
}

TEST(Executor, StopsOnASignal) {
  Executor executor;
  ASSERT_TRUE(executor.stop_on({SIGUSR1}));
  TaskGroup tasks(executor);
  tasks.post([] { kill(getpid(), SIGUSR1); });
  executor.run();
}

TEST(Executor, StopsOnASignalWhileItIsBusy) {
  Executor executor;
  ASSERT_TRUE(executor.stop_on({SIGUSR1}));
  TaskGroup tasks(executor);
  std::function<void()> forever = [&] { tasks.post(forever); };
  tasks.post(forever);
  tasks.post([] { kill(getpid(), SIGUSR1); });
  executor.run();
}

TEST(Executor, SleepsWithoutUsingTheProcessor) {
  Executor executor;
  TaskGroup tasks(executor);
  tasks.post_at(Clock::now() + 300ms, [&] { executor.stop(); });
  rusage before{}, after{};
  getrusage(RUSAGE_THREAD, &before);
  executor.run();
  getrusage(RUSAGE_THREAD, &after);
  EXPECT_LE(after.ru_nvcsw - before.ru_nvcsw, 20);  // a poll every 10 ms would need 30
}

TEST(TaskGroup, TakesItsTasksWithIt) {
  Executor executor;
  TaskGroup tasks(executor);
  bool ran = false;
  {
    TaskGroup gone(executor);
    gone.post([&] { ran = true; });
    gone.post_at(Clock::now(), [&] { ran = true; });
  }
  tasks.post_at(Clock::now() + 10ms, [&] { executor.stop(); });
  executor.run();
  EXPECT_FALSE(ran);
}

TEST(TaskGroup, DropsWhatIsPostedAfterItWasClosed) {
  Executor executor;
  TaskGroup tasks(executor);
  TaskGroup closed(executor);
  closed.close();
  bool ran = false;
  closed.post([&] { ran = true; });
  closed.post_at(Clock::now(), [&] { ran = true; });
  tasks.post_at(Clock::now() + 10ms, [&] { executor.stop(); });
  executor.run();
  EXPECT_FALSE(ran);
}

TEST(TaskGroup, WaitsForTheTaskThatRuns) {
  Executor executor;
  auto tasks = std::make_unique<TaskGroup>(executor);
  std::promise<void> began;
  std::atomic<bool> ended = false;
  tasks->post([&] {
    began.set_value();
    std::this_thread::sleep_for(50ms);
    ended = true;
  });
  std::thread thread([&] { executor.run(); });
  began.get_future().wait();
  tasks.reset();
  EXPECT_TRUE(ended);
  executor.stop();
  thread.join();
}

TEST(TaskGroup, MayBeDestroyedByItsOwnTask) {
  Executor executor;
  TaskGroup tasks(executor);
  auto own = std::make_unique<TaskGroup>(executor);
  bool ran_again = false;
  own->post([&] { own.reset(); });
  own->post([&] { ran_again = true; });
  tasks.post([&] { executor.stop(); });
  executor.run();
  EXPECT_EQ(own, nullptr);
  EXPECT_FALSE(ran_again);
}

TEST(TaskGroup, CancelsOneTimer) {
  Executor executor;
  TaskGroup tasks(executor);
  std::vector<int> ran;
  const auto now = Clock::now();
  tasks.post_at(now + 1ms, [&] { ran.push_back(1); });
  const auto second = tasks.post_at(now + 1ms, [&] { ran.push_back(2); });
  tasks.post_at(now + 2ms, [&] { executor.stop(); });
  tasks.cancel(second);
  executor.run();
  tasks.cancel(second);  // gone already
  EXPECT_THAT(ran, ElementsAre(1));
}

TEST(Timer, TicksUntilItIsDestroyed) {
  Executor executor;
  TaskGroup tasks(executor);
  int ticks = 0;
  std::optional<Timer> timer;
  timer.emplace(executor, 5ms, [&] {
    if (++ticks == 3) tasks.post([&] { timer.reset(); });
  });
  tasks.post_at(Clock::now() + 100ms, [&] { executor.stop(); });
  executor.run();
  EXPECT_EQ(ticks, 3);
}

TEST(Timer, LeavesOutThePeriodsThatPassedWhileTheThreadWasBusy) {
  Executor executor;
  TaskGroup tasks(executor);
  int ticks = 0;
  const Timer timer(executor, 10ms, [&] {
    if (++ticks == 1) std::this_thread::sleep_for(95ms);
  });
  tasks.post_at(Clock::now() + 107ms,
                [&] { executor.stop(); });  // the first at 10, the next due at 110
  executor.run();
  EXPECT_EQ(ticks, 1);
}

}  // namespace
}  // namespace culprit::ros2
