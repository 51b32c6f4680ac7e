// What names of nodes, topics and services mean in rule files.
#pragma once

#include <string>

namespace culprit {

// "/robot/camera" -> "camera".
std::string own_name(const std::string& full_name);
// "/robot/camera" -> "/robot"; empty for "/camera".
std::string namespace_of(const std::string& full_name);

// What the node means by a topic: "/x" as it is, "x" in the node's namespace, "~/x" below the node.
std::string topic_of(const std::string& topic, const std::string& node);
// "~/recalibrate" and "recalibrate" are the node's own; "/x" stays.
std::string service_of(const std::string& service, const std::string& node);

// As a rule file writes the name of a status, a key or a parameter: in quotes where it has to be;
// empty where it cannot be written.
std::string as_written(const std::string& name);

}  // namespace culprit
