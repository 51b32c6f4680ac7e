// Files of parameters as ROS 2 has them (--params-file): which of their values are a node's.
//
//     /**:                         # every node; also /robot/* and /robot/**
//       ros__parameters: {use_sim_time: false}
//     detector:                    # the node /detector
//       ros__parameters:
//         threshold: 0.5
//         camera: {rate: 10}       # camera.rate
//
// Later lines win over earlier ones. A quoted value is text.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "ros2/messages.h"

namespace culprit::owners {

// The parameters that the file has for the node of this full name, by name. Errors: it is no
// regular file of 1 MB at most, cannot be read, or is none of parameters; with the line.
Expected<std::vector<ros2::msg::Parameter>> read_parameter_file(const std::string& path,
                                                                const std::string& node);

// The value that `-p name:=text` sets, as rcl reads it: YAML. Errors: it is no value.
Expected<ros2::msg::ParameterValue> parse_parameter_value(const std::string& text);

// As YAML has it: "true", "3", "0.5", "[1, 2]"; empty for what is not set.
std::string to_yaml(const ros2::msg::ParameterValue& value);

}  // namespace culprit::owners
