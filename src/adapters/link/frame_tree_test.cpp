#include "link/frame_tree.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

constexpr Time kStart{};

ros2::msg::TransformStamped edge(const char* parent, const char* child, double x, double y,
                                 double yaw) {
  return {{{}, parent}, child, {{x, y, 0}, {0, 0, std::sin(yaw / 2), std::cos(yaw / 2)}}};
}

TEST(FrameTree, PlacesARobotByAllTransformsInBetween) {
  FrameTree tree;
  tree.add({{edge("map", "odom", 10, 0, std::numbers::pi / 2)}}, FrameTree::Kind::kMoving, kStart);
  tree.add({{edge("odom", "base_link", 2, 0, 0)}}, FrameTree::Kind::kMoving, kStart + 3s);
  const auto placed = tree.place("base_link", "map", kStart + 4s);
  ASSERT_TRUE(placed);
  EXPECT_NEAR(placed->transform.translation.x, 10, 1e-9);
  EXPECT_NEAR(placed->transform.translation.y, 2, 1e-9);
  EXPECT_NEAR(yaw_of(placed->transform.rotation), std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(placed->age, 4s) << "it is as old as the oldest of them";
  EXPECT_FALSE(tree.place("map", "base_link", kStart)) << "only upwards";
  EXPECT_FALSE(tree.place("base_link", "world", kStart));
}

TEST(FrameTree, AStaticTransformDoesNotAge) {
  FrameTree tree;
  tree.add({{edge("base_link", "laser", 0.1, 0, 0)}}, FrameTree::Kind::kStatic, kStart);
  EXPECT_EQ(tree.place("laser", "base_link", kStart + 24h)->age, 0s);
}

// Its beams turn the other way round on the map.
TEST(FrameTree, KnowsALaserThatIsMountedUpsideDown) {
  FrameTree tree;
  ros2::msg::TransformStamped upside_down = edge("base_link", "laser", 0, 0, 0);
  upside_down.transform.rotation = {1, 0, 0, 0};
  tree.add({{upside_down}}, FrameTree::Kind::kStatic, kStart);
  const ros2::msg::Vector3 left =
      moved_by(tree.place("laser", "base_link", kStart)->transform, {0, 1, 0});
  EXPECT_NEAR(left.y, -1, 1e-9);
}

TEST(FrameTree, SurvivesARingAndNumbersThatAreNone) {
  FrameTree tree;
  tree.add({{edge("b", "a", 1, 0, 0), edge("a", "b", 1, 0, 0),
             edge("map", "far", std::numeric_limits<double>::quiet_NaN(), 0, 0)}},
           FrameTree::Kind::kMoving, kStart);
  EXPECT_FALSE(tree.place("a", "map", kStart));
  EXPECT_FALSE(tree.place("far", "map", kStart));
}

TEST(FrameTree, KeepsNoNamesThatOnlyTakeMemory) {
  FrameTree tree;
  const std::string longest(FrameTree::kLongestName, 'f');
  const std::string longer = longest + "f";
  tree.add({{edge("map", longest.c_str(), 1, 0, 0), edge("map", longer.c_str(), 1, 0, 0),
             edge(longer.c_str(), "base_link", 1, 0, 0)}},
           FrameTree::Kind::kMoving, kStart);
  EXPECT_TRUE(tree.place(longest, "map", kStart));
  EXPECT_FALSE(tree.place(longer, "map", kStart));
  EXPECT_FALSE(tree.place("base_link", longer, kStart));
}

TEST(FrameTree, FindsARobotInItsNamespace) {
  FrameTree tree;
  tree.add({{edge("odom", "rover1/base_link", 0, 0, 0), edge("odom", "no_base_link", 0, 0, 0)}},
           FrameTree::Kind::kMoving, kStart);
  EXPECT_EQ(tree.called("base_link"), std::vector<std::string>{"rover1/base_link"});
}

}  // namespace
}  // namespace culprit::link
