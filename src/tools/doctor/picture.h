// A robot as it was seen for some seconds: what findings are made of. Plain data, so that each kind
// of finding can be tested without a robot.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ros2/graph.h"
#include "ros2/messages.h"

namespace culprit::doctor {

struct Picture {
  std::uint32_t domain = 0;
  std::vector<ros2::Graph::NodeView> nodes;
  // All nodes of a name that more than one has, in processes that are not known to have ended.
  std::map<std::string, std::vector<ros2::GraphNode>> namesakes;
  // Nodes that did not answer a request in time, and whether their process has ended.
  struct Unanswered {
    double seconds = 0;  // how long an answer was waited for
    bool has_ended = false;
  };
  std::map<std::string, Unanswered> unanswered;
  // The last report of each diagnostic status.
  std::map<std::string, ros2::msg::DiagnosticStatus> statuses;
};

}  // namespace culprit::doctor
