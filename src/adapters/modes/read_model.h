// The model file of system_modes: YAML text -> checked Model.
//
//     actuation:
//       ros__parameters:
//         type: system
//         parts: drive_base manipulator          # or a list
//         modes:
//           __DEFAULT__: {drive_base: active, manipulator: inactive}
//           FAST:        {drive_base: active.FAST}
//         rules:
//           slow_down: {if_target: active.FAST, if_part: [drive_base, inactive], new_target:
//           inactive}
//     drive_base:
//       ros__parameters:
//         type: node
//         modes:
//           __DEFAULT__: {ros__parameters: {max_speed: 0.1}}
//           FAST:        {ros__parameters: {max_speed: 0.9}}
//
// As in a ROS 2 parameter file, an entry without ros__parameters is a namespace. A mode begins as a
// copy of the default, which comes first. "active" means active.__DEFAULT__.
#pragma once

#include <string>

#include "base/expected.h"
#include "modes/model.h"

namespace culprit::modes {

// Errors say "file:line:column: the fault and the remedy": no YAML, no __DEFAULT__, parts, modes or
// parameters that there are not, systems that are parts of themselves. Any text is safe.
Expected<Model> read_model(const std::string& file, const std::string& text);

}  // namespace culprit::modes
