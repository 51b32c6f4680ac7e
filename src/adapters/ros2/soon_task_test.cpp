#include "ros2/soon_task.h"

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

TEST(SoonTask, RunsOnceForAllThatAskedBefore) {
  Executor executor;
  TaskGroup tasks(executor);
  int asked = 0;
  int seen = 0;
  int runs = 0;
  SoonTask soon(tasks, [&] {
    ++runs;
    seen = asked;
  });
  for (int i = 0; i < 1000; ++i) {
    tasks.post([&] {
      ++asked;
      soon.post();
    });
  }
  tasks.post([&] {
    tasks.post([&] {
      EXPECT_EQ(runs, 1);
      EXPECT_EQ(seen, 1000) << "it comes after them";
      soon.post();
      tasks.post([&executor] { executor.stop(); });
    });
  });
  executor.run();
  EXPECT_EQ(runs, 2);
}

}  // namespace
}  // namespace culprit::ros2
