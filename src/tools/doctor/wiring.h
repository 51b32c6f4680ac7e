// The connections: the endpoints of a picture, by topic and service. A view of the picture, which must outlive it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "doctor/picture.h"

namespace culprit::doctor {

struct End {
  const std::string& node;
  ros2::Vendor vendor = ros2::Vendor::kOther;
  const ros2::GraphEndpoint& endpoint;
};

// For a topic, its publishers and subscribers; for a service, its clients, which send, and its
// servers.
struct Channel {
  std::vector<End> senders;
  std::vector<End> receivers;
};

struct Wiring {
  std::map<std::string, Channel> topics;
  std::map<std::string, Channel> services;
};

// Without the endpoints of hidden nodes, which belong to tools.
Wiring wiring_of(const Picture& picture);
Wiring wiring_of(Picture&& picture) = delete;

// A topic or service that each node has: those of its parameters, and the topics of ROS 2 itself.
bool is_name_of_each_node(const std::string& name);

// Whether any of them is of a node of the robot, not of a tool.
bool has_robots_end(const std::vector<End>& ends);

}  // namespace culprit::doctor
