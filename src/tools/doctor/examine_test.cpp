// Each kind of finding: exactly that fault, and nothing else is found.
#include "doctor/examine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr ros2::Qos kBestEffort{.reliability = ros2::Reliability::kBestEffort};
constexpr ros2::Qos kLatched{.durability = ros2::Durability::kTransientLocal};

ros2::GraphEndpoint publishes(std::string topic, ros2::Qos qos = {},
                              std::string type = "sensor_msgs/msg/LaserScan") {
  return {EndpointKind::kPublisher, std::move(topic), std::move(type), qos};
}

ros2::GraphEndpoint reads(std::string topic, ros2::Qos qos = {},
                          std::string type = "sensor_msgs/msg/LaserScan") {
  return {EndpointKind::kSubscriber, std::move(topic), std::move(type), qos};
}

// A robot of two nodes: /lidar with `from`, /slam with `to`.
Picture robot_with(ros2::GraphEndpoint from, ros2::GraphEndpoint to) {
  Picture picture;
  picture.nodes = {{{"/lidar", ros2::Vendor::kFastDds, "", 11}, {std::move(from)}},
                   {{"/slam", ros2::Vendor::kFastDds, "", 12}, {std::move(to)}}};
  return picture;
}

Finding only_finding(const Picture& picture) {
  const std::vector<Finding> findings = examine(picture);
  EXPECT_THAT(findings, SizeIs(1));
  return findings.empty() ? Finding{} : findings.front();
}

TEST(Examine, FindsNothingWhereEverybodyHearsEverybody) {
  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/scan"))), IsEmpty());
  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/scan", kBestEffort))), IsEmpty());
  EXPECT_THAT(examine(robot_with(publishes("/map", kLatched), reads("/map"))), IsEmpty())
      << "it misses what was published before, as it asked for";
  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/joy"))), IsEmpty())
      << "an input that nobody feeds, and nobody may mean";
}

TEST(Examine, D001ReliabilityThatIsNotOffered) {
  const Finding finding = only_finding(robot_with(publishes("/scan", kBestEffort), reads("/scan")));
  EXPECT_EQ(finding.code, "D001");
  EXPECT_EQ(finding.gravity, Gravity::kError);
  EXPECT_EQ(finding.who, "/scan: /lidar → /slam");
  EXPECT_EQ(finding.seen, "reliability: offered is best effort, requested is reliable");
}

TEST(Examine, D001DurabilityThatIsNotOffered) {
  const Finding finding = only_finding(robot_with(publishes("/map"), reads("/map", kLatched)));
  EXPECT_EQ(finding.code, "D001");
  EXPECT_EQ(finding.seen, "durability: offered is volatile, requested is transient local");
}

TEST(Examine, D001DeadlineThatIsNotOffered) {
  const ros2::Qos within_100_ms{.deadline = 100ms};
  const Finding never = only_finding(robot_with(publishes("/scan"), reads("/scan", within_100_ms)));
  EXPECT_EQ(never.seen, "deadline: offered is none, requested is 0.1 s");
  const ros2::Qos within_a_second{.deadline = 1s};
  const Finding late =
      only_finding(robot_with(publishes("/scan", within_a_second), reads("/scan", within_100_ms)));
  EXPECT_EQ(late.seen, "deadline: offered is 1 s, requested is 0.1 s");
  EXPECT_THAT(
      examine(robot_with(publishes("/scan", within_100_ms), reads("/scan", within_a_second))),
      IsEmpty());
}

TEST(Examine, D002TypesThatDiffer) {
  const Finding finding = only_finding(
      robot_with(publishes("/scan"), reads("/scan", kBestEffort, "sensor_msgs/msg/PointCloud2")));
  EXPECT_EQ(finding.code, "D002");
  EXPECT_EQ(finding.seen,
            "published as sensor_msgs/msg/LaserScan, subscribed to as sensor_msgs/msg/PointCloud2");
}

TEST(Examine, D003ANameThatIsOneLetterOffOrInAnotherNamespace) {
  const Finding slip = only_finding(robot_with(publishes("/scan"), reads("/scam")));
  EXPECT_EQ(slip.code, "D003");
  EXPECT_EQ(slip.gravity, Gravity::kWarning);
  EXPECT_THAT(slip.seen, HasSubstr("nobody publishes /scam, and nobody reads /scan of /lidar"));
  EXPECT_EQ(only_finding(robot_with(publishes("/front/scan"), reads("/scan"))).code, "D003");

  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/scam", {}, "std_msgs/msg/String"))),
              IsEmpty())
      << "another type is another thing";
  Picture read = robot_with(publishes("/scan_1"), reads("/scan_2"));
  read.nodes[1].endpoints.push_back(reads("/scan_1"));
  EXPECT_THAT(examine(read), IsEmpty()) << "the near one has its reader";
}

TEST(Examine, D010TwoNodesOfOneName) {
  Picture picture = robot_with(publishes("/scan"), reads("/scan"));
  picture.namesakes["/lidar"] = {{"/lidar", ros2::Vendor::kFastDds, "", 11},
                                 {"/lidar", ros2::Vendor::kFastDds, "rover2", 0}};
  const Finding finding = only_finding(picture);
  EXPECT_EQ(finding.code, "D010");
  EXPECT_EQ(finding.seen, "2 nodes have this name: process 11, a process on rover2");
}

TEST(Examine, D011WhatHasEndedAndD012WhatHangs) {
  Picture picture = robot_with(publishes("/scan"), reads("/scan"));
  picture.unanswered["/slam"] = {4, false};
  EXPECT_EQ(only_finding(picture).code, "D012");
  EXPECT_EQ(only_finding(picture).seen,
            "it has not answered a question about its parameters for 4.0 s");
  picture.unanswered["/slam"].has_ended = true;
  EXPECT_EQ(only_finding(picture).code, "D011");
}

TEST(Examine, D020WhatReportsItselfIll) {
  Picture picture = robot_with(publishes("/scan"), reads("/scan"));
  picture.statuses["motor"] = {2, "motor", "overheated", "m1", {}};
  picture.statuses["battery"] = {1, "battery", "low", "b1", {}};
  picture.statuses["gps"] = {3, "gps", "", "g1", {}};
  const std::vector<Finding> findings = examine(picture);
  ASSERT_THAT(findings, SizeIs(2));
  EXPECT_EQ(findings[0].seen, "its diagnostic status is ERROR: overheated");
  EXPECT_EQ(findings[0].gravity, Gravity::kError);
  EXPECT_EQ(findings[1].who, "gps") << "the worst first";
  EXPECT_EQ(findings[1].gravity, Gravity::kWarning);
}

TEST(Examine, D030NobodyThere) {
  Picture nobody;
  nobody.domain = 7;
  EXPECT_EQ(only_finding(nobody).who, "domain 7");
}

}  // namespace
}  // namespace culprit::doctor
