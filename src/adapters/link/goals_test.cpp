#include "link/goals.h"

#include <gtest/gtest.h>

#include "ros2/messages.h"

namespace culprit::link {
namespace {

TEST(Goals, AreReadWithTheirStatus) {
  ros2::msg::GoalStatusArray array;
  array.status_list.resize(3);
  array.status_list[0].goal_info.goal_id[0] = 1;
  array.status_list[0].status = 6;
  array.status_list[1].goal_info.goal_id[15] = 1;
  array.status_list[1].status = 2;
  array.status_list[2].status = 42;
  const auto seen = goals_in(TopicId(3), rtps::encode(array));
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->topic, TopicId(3));
  ASSERT_EQ(seen->goals.size(), 3u);
  EXPECT_EQ(seen->goals[0].status, GoalStatus::kAborted);
  EXPECT_EQ(seen->goals[1].status, GoalStatus::kExecuting);
  EXPECT_EQ(seen->goals[2].status, GoalStatus::kUnknown);
  EXPECT_NE(seen->goals[0].id, seen->goals[1].id);
  EXPECT_FALSE(goals_in(TopicId(0), rtps::Bytes{1, 2, 3}));
}

}  // namespace
}  // namespace culprit::link
