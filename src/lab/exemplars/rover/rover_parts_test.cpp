// The rover's algorithms and its lifecycle manager, without a node.
#include <gtest/gtest.h>

#include "exemplars/rover/bond_manager.h"
#include "exemplars/rover/particle_filter.h"
#include "exemplars/rover/path_search.h"
#include "exemplars/rover/pure_pursuit.h"
#include "exemplars/rover/world.h"

namespace culprit::rover {
namespace {

TEST(RoverMap, ARayEndsAtTheFirstWall) {
  GridMap map(100, 20);
  map.set_wall(50, 10);  // from 5.0 m to 5.1 m
  EXPECT_NEAR(map.ray({1.05, 1.05, 0}, 8), 3.95, GridMap::kResolution / 2);
  EXPECT_NEAR(map.ray({1.05, 1.05, std::numbers::pi}, 8), 1.05, GridMap::kResolution / 2);
  EXPECT_EQ(map.ray({1.05, 0.55, 0}, 3), 3);
}

TEST(RoverMap, ComesBackFromItsMessage) {
  const GridMap map = GridMap::house();
  const GridMap again = GridMap::from_message(map.to_message());
  for (int row = 0; row < map.height(); ++row)
    for (int column = 0; column < map.width(); ++column)
      ASSERT_EQ(again.is_wall(column, row), map.is_wall(column, row));
}

TEST(RoverPathSearch, LeadsThroughTheDoorAndKeepsAwayFromWalls) {
  const CostGrid costs(GridMap::house(), {});
  const auto path = search_path(costs, World::kStart, {1.5, 5.5, 0});
  ASSERT_FALSE(path.empty());
  EXPECT_NEAR(path.back().x, 1.5, 0.01);
  for (const Pose2& pose : path) EXPECT_LT(costs.at(pose), CostGrid::kLethal);
}

TEST(RoverPathSearch, FindsNoneIntoAWallOrPastAClosedDoor) {
  const GridMap house = GridMap::house();
  EXPECT_TRUE(search_path(CostGrid(house, {}), World::kStart, {0.2, 0.2, 0}).empty());
  std::vector<Pose2> crowd;  // across the lower left room's door and the passages beside it
  for (double x = 0.5; x < 12; x += 0.1) crowd.push_back({x, 2.2, 0});
  EXPECT_TRUE(search_path(CostGrid(house, crowd), World::kStart, {2, 1.2, 0}).empty());
}

TEST(RoverPursuit, FollowsAPathToItsEnd) {
  World world(1);
  const auto path = search_path(CostGrid(world.map(), {}), world.robot(), {1.5, 5.5, 0});
  for (int i = 0; i < 1000 && distance(world.robot(), path.back()) > 0.2; ++i) {
    const Command command = pursue(path, world.robot(), 0.5);
    world.drive(command.speed, command.turn);
    world.step(0.05);
  }
  EXPECT_LT(distance(world.robot(), path.back()), 0.2);
}

TEST(RoverPursuit, SeesHowFarTheWayIsFree) {
  const auto is_occupied = [](const Pose2& pose) { return pose.x > 1.95; };
  EXPECT_NEAR(free_length({}, {0.5, 0}, 3, is_occupied), 1.9, 0.01);
  EXPECT_EQ(free_length({}, {0.5, 0}, 1, is_occupied), 1);
}

TEST(RoverParticleFilter, StaysWithARobotThatDrives) {
  World world(1);
  ParticleFilter filter(world.map(), 1);
  filter.place(world.robot());
  Pose2 last = world.robot();
  for (int i = 0; i < 100; ++i) {
    world.drive(0.4, i % 40 < 20 ? 0.6 : -0.6);
    for (int j = 0; j < 4; ++j) world.step(0.05);
    const auto ranges = world.scan();
    filter.update(inverse(last) * world.robot(), {ranges, World::kLidarRange});
    last = world.robot();
  }
  EXPECT_LT(distance(filter.estimate().pose, world.robot()), 0.2);
  EXPECT_GT(filter.estimate().match, 0.7);
}

TEST(RoverParticleFilter, NoticesThatItIsLostAndFindsItself) {
  World world(1);
  ParticleFilter filter(world.map(), 1);
  filter.place(world.robot());
  world.kidnap({10, 5.9, 1});
  for (int i = 0; i < 10; ++i) {
    const auto ranges = world.scan();
    filter.update({}, {ranges, World::kLidarRange});
  }
  EXPECT_LT(filter.estimate().match, 0.6);
  const auto ranges = world.scan();
  filter.place_anywhere({ranges, World::kLidarRange});
  EXPECT_LT(distance(filter.estimate().pose, world.robot()), 0.3);
  EXPECT_GT(filter.estimate().match, 0.7);
}

TEST(RoverWorld, ARobotStopsAtAWallAndPeopleTurnBackBeforeIt) {
  World world(1);
  world.kidnap({6, 2.6, -std::numbers::pi / 2});
  world.drive(0.5, 0);
  for (int i = 0; i < 200; ++i) world.step(0.05);
  EXPECT_EQ(world.collisions(), 1);
  EXPECT_TRUE(world.is_free(world.robot()));
  World other(1);
  other.kidnap({6, 3.7, 0});
  for (int i = 0; i < 400; ++i) other.step(0.05);
  EXPECT_GT(distance(other.people().front(), other.robot()), 0.5);
}

TEST(RoverBondManager, StartsAllUpAndPausesBackwardsAndResumesOnRequest) {
  using Changes = std::vector<std::pair<std::size_t, Transition>>;
  Changes changes;
  BondManager manager({.count = 2,
                       .reach = [](std::size_t) { return BondManager::Reach::kAnswers; },
                       .pid = [](std::size_t) { return 1; },
                       .change =
                           [&](std::size_t server, Transition transition) {
                             changes.emplace_back(server, transition);
                             return true;
                           },
                       .answer_time = [] { return Duration::zero(); }},
                      false);
  Time now{};
  const auto changed = [&] {
    for (int i = 0; i < 20; ++i) manager.step(now = later(now, std::chrono::milliseconds(100)));
    return std::exchange(changes, {});
  };
  using enum Transition;
  manager.begin(now);
  EXPECT_EQ(changed(), (Changes{{0, kConfigure}, {1, kConfigure}, {0, kActivate}, {1, kActivate}}));
  std::vector<bool> answers;
  const auto answer = [&](bool is_done) { answers.push_back(is_done); };
  manager.ask(1, answer);
  EXPECT_EQ(changed(), (Changes{{1, kDeactivate}, {0, kDeactivate}}));
  EXPECT_TRUE(manager.is_stuck());
  manager.ask(2, answer);
  EXPECT_EQ(changed(), (Changes{{0, kActivate}, {1, kActivate}}));
  EXPECT_FALSE(manager.is_stuck());
  manager.ask(9, answer);
  EXPECT_EQ(changed(), Changes{});
  EXPECT_EQ(answers, (std::vector<bool>{true, true, false}));
}

}  // namespace
}  // namespace culprit::rover
