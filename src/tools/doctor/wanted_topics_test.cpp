#include "doctor/wanted_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/test_picture.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

TEST(WantedTopics, AreThoseThatARobotsNodeReadsAndThatTellSomething) {
  Picture picture = robot();
  const auto names = [&](Extent extent) {
    std::vector<std::string> all;
    for (const WantedTopic& each : wanted_topics(picture, extent)) all.push_back(each.name);
    return all;
  };
  picture.nodes[0].endpoints = {
      publishes("/scan"), publishes("/unread"), publishes("/text", {}, kString),
      publishes("/map", kLatched, kString), publishes("/tf", {}, "tf2_msgs/msg/TFMessage")};
  picture.nodes[1].endpoints = {reads("/scan"), reads("/text", {}, kString),
                                reads("/map", {}, kString),
                                reads("/tf", {}, "tf2_msgs/msg/TFMessage")};
  picture.nodes.push_back(node("/rviz2", 13, {reads("/unread")}));
  EXPECT_THAT(names(Extent::kFindings), ElementsAre("/map", "/scan"));
  EXPECT_THAT(names(Extent::kEverything), ElementsAre("/map", "/scan", "/text"));
  picture.nodes[1].endpoints[1].qos.deadline = 100ms;
  EXPECT_THAT(names(Extent::kFindings), ElementsAre("/text", "/map", "/scan"))
      << "first those whose silence is a finding";
}

}  // namespace
}  // namespace culprit::doctor
