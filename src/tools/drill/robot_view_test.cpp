#include "drill/robot_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::drill {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Topics /fast and /slow, of 10 Hz and 1 Hz, so long after their last message.
RobotView aged(double fast, double slow) {
  const Json robot{{"topics", {"/fast", "/slow"}}};
  const Json state{{"topics", {{{"rate", 0}, {"age", fast}}, {{"rate", 0}, {"age", slow}}}}};
  return {robot, Json(), state};
}

TEST(RobotView, SilentIsWhatMissesThreeOfItsUsualMessages) {
  HealthyRobot healthy;
  healthy.topics = {{"/fast", {10, "camera", {}}}, {"/slow", {1, "map", {}}}};
  EXPECT_THAT(aged(0.2, 2).silent(healthy), IsEmpty());
  EXPECT_THAT(aged(0.4, 2).silent(healthy), ElementsAre("camera"));
  EXPECT_THAT(aged(0.2, 3.5).silent(healthy), ElementsAre("map"))
      << "its rate over a second is 0 by then";
}

TEST(RobotView, ATopicWithoutASubscriberHasItsPublisherFromElsewhere) {
  const Json robot{{"topics", {"/rgb"}}, {"components", {{{"name", "camera"}}}}};
  const Json graph{{"nodes", {{{"node", "/cam"}, {"component", "camera"}}}}};
  const Json state{{"topics", {{{"rate", 10}}}}, {"components", {{{"alive", true}}}}};
  const RobotView view(robot, graph, state);
  EXPECT_THAT(view.topics(), ElementsAre("/rgb"));
  EXPECT_EQ(view.healthy().topics.at("/rgb").publisher, "");
  EXPECT_EQ(view.healthy({{"/rgb", "/cam"}}).topics.at("/rgb").publisher, "camera");
}

TEST(RobotView, OfDocumentsThatSayNothingIsNotWell) {
  EXPECT_THAT(RobotView(Json(), Json(), Json()).complaints(), testing::SizeIs(1));
}

}  // namespace
}  // namespace culprit::drill
