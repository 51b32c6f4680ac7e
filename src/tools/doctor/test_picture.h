// Pictures of small robots, for the tests of what is found in them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/examine.h"

namespace culprit::doctor {

inline constexpr rtps::Qos kBestEffort{.reliability = rtps::Reliability::kBestEffort};
inline constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal};
inline constexpr const char* kScan = "sensor_msgs/msg/LaserScan";
inline constexpr const char* kString = "std_msgs/msg/String";

inline ros2::GraphEndpoint publishes(std::string topic, rtps::Qos qos = {},
                                     std::string type = kScan) {
  return {EndpointKind::kPublisher, std::move(topic), std::move(type), qos};
}
inline ros2::GraphEndpoint reads(std::string topic, rtps::Qos qos = {}, std::string type = kScan) {
  return {EndpointKind::kSubscriber, std::move(topic), std::move(type), qos};
}
inline ros2::GraphEndpoint serves(std::string service, std::string type = "std_srvs/srv/Trigger") {
  return {EndpointKind::kServer, std::move(service), std::move(type), {}};
}
inline ros2::GraphEndpoint calls(std::string service, std::string type = "std_srvs/srv/Trigger") {
  return {EndpointKind::kClient, std::move(service), std::move(type), {}};
}

inline Node node(std::string name, int pid, std::vector<ros2::GraphEndpoint> endpoints) {
  return {{std::move(name), ros2::Vendor::kFastDds, "", pid}, std::move(endpoints)};
}

// A robot of two nodes: /lidar with `from`, /slam with `to`.
inline Picture robot_with(ros2::GraphEndpoint from, ros2::GraphEndpoint to) {
  Picture picture;
  picture.looked = std::chrono::seconds(8);
  picture.nodes = {node("/lidar", 11, {std::move(from)}), node("/slam", 12, {std::move(to)})};
  return picture;
}

inline Picture robot() { return robot_with(publishes("/scan"), reads("/scan")); }

// The only one that there is.
inline Finding only_finding(const Picture& picture) {
  const std::vector<Finding> findings = examine(picture);
  EXPECT_THAT(findings, testing::SizeIs(1));
  return findings.empty() ? Finding{} : findings.front();
}

}  // namespace culprit::doctor
