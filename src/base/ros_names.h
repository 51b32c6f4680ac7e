// Resolves the names of nodes, topics and services in rule files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit {

// "/robot/camera" -> "camera".
std::string own_name(const std::string& full_name);
// "/robot/camera" -> "/robot"; empty for "/camera".
std::string namespace_of(const std::string& full_name);

// The absolute name of a topic that the node uses: "/x" as it is, "x" in the node's namespace,
// "~/x" below the node.
std::string topic_of(const std::string& topic, const std::string& node);
// "~/recalibrate" and "recalibrate" are the node's own; "/x" stays.
std::string service_of(const std::string& service, const std::string& node);

// As a rule file writes the name of a status, a key or a parameter: in quotes where it has to be;
// empty where it cannot be written.
std::string as_written(const std::string& name);

// The full name among `known` that was probably meant by `name`, which is not there: the only one
// of the same own name in another namespace, or one with a slip of the fingers. Empty if there is
// none.
std::string closest_full_name(const std::string& name, const std::vector<std::string_view>& known);

}  // namespace culprit
