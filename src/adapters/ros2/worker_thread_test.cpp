#include "ros2/worker_thread.h"

#include <future>
#include <memory>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

TEST(WorkerThread, DoesWhatSeveralThreadsPutOneAfterTheOther) {
  constexpr int kEach = 200;
  std::vector<std::pair<int, int>> done;  // touched by the worker only
  {
    WorkerThread worker(3 * kEach + 1);
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 3; ++thread)
      threads.emplace_back([&worker, &done, thread] {
        for (int i = 0; i < kEach; ++i)
          EXPECT_TRUE(worker.put([&done, thread, i] { done.emplace_back(thread, i); }));
      });
    for (std::thread& each : threads) each.join();
    std::promise<void> last;
    ASSERT_TRUE(worker.put([&last] { last.set_value(); }));
    last.get_future().wait();
  }
  ASSERT_EQ(done.size(), 3u * kEach);
  std::vector<int> next(3, 0);
  for (const auto& [thread, i] : done) EXPECT_EQ(i, next[thread]++) << "of thread " << thread;
}

TEST(WorkerThread, RefusesWhatWouldWaitBehindTooMuch) {
  WorkerThread worker(2);
  std::promise<void> begun, disk;
  std::promise<void> last;
  ASSERT_TRUE(worker.put([&] {
    begun.set_value();
    disk.get_future().wait();
  }));
  begun.get_future().wait();
  EXPECT_TRUE(worker.put([] {}));
  EXPECT_TRUE(worker.put([&last] { last.set_value(); }));
  EXPECT_FALSE(worker.put([] { FAIL() << "it was refused"; }));
  disk.set_value();
  last.get_future().wait();
}

TEST(WorkerThread, EndsWhenWhatIsBeingDoneIsDone) {
  bool is_finished = false;
  std::promise<void> begun, disk;
  auto worker = std::make_unique<WorkerThread>(1);
  ASSERT_TRUE(worker->put([&] {
    begun.set_value();
    disk.get_future().wait();
    is_finished = true;
  }));
  begun.get_future().wait();
  std::thread later([&disk] { disk.set_value(); });
  worker.reset();
  EXPECT_TRUE(is_finished);
  later.join();
}

}  // namespace
}  // namespace culprit::ros2
