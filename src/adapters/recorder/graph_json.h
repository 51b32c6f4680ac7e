// A robot's graph as JSON: its nodes with their processes, and the topics and services that each
// publishes, subscribes to, serves and calls.
#pragma once

#include <string>

#include "ros2/graph.h"

namespace culprit::recorder {

// {"nodes": [{"name": …, "host": …, "process": …, "publishes": {topic: type}, "subscribes": …, "serves": …, "calls": …}]}
std::string graph_to_json(const ros2::Graph& graph);

}  // namespace culprit::recorder
