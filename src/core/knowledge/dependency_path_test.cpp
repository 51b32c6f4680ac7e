#include "knowledge/dependency_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Edge = DependencyGraph::Edge;

TEST(DependencyPath, IsTheShortestOne) {
  const std::vector<Edge> edges = {{"/base", "/planner", "/cmd"},
                                   {"/planner", "/map", "/costs"},
                                   {"/planner", "/lidar", "/scan"},
                                   {"/map", "/lidar", "/scan"},
                                   {"/lidar", "/base", "/odom"}};
  EXPECT_THAT(dependency_path(edges, "/base", "/lidar"),
              ElementsAre(Edge{"/base", "/planner", "/cmd"}, Edge{"/planner", "/lidar", "/scan"}));
  EXPECT_THAT(dependency_path(edges, "/map", "/planner"),
              ElementsAre(Edge{"/map", "/lidar", "/scan"}, Edge{"/lidar", "/base", "/odom"},
                          Edge{"/base", "/planner", "/cmd"}));
}

TEST(DependencyPath, IsEmptyWhereNothingTiesThem) {
  const std::vector<Edge> edges = {{"/base", "/planner", "/cmd"}};
  EXPECT_THAT(dependency_path(edges, "/planner", "/base"), IsEmpty());
  EXPECT_THAT(dependency_path(edges, "/base", "/nobody"), IsEmpty());
  EXPECT_THAT(dependency_path(edges, "/base", "/base"), IsEmpty());
}

}  // namespace
}  // namespace culprit
