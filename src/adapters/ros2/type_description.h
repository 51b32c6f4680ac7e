// Describes a message type, and names it by what it looks like, as ROS 2 Iron and newer announce it for every endpoint
// (REP 2011, "RIHS01"): the SHA-256 of the fields of the type and of all types in it. Two programs
// that say the same hash mean the same type, whatever their files say.
#pragma once

#include <string>
#include <string_view>

#include "base/expected.h"
#include "ros2/message_definition.h"
#include "ros2/messages.h"

namespace culprit::ros2 {

// "RIHS01_" and 64 digits. `definitions`: of `type` and of all types in it, and no others.
// @pre `type` is among them
std::string type_hash(std::string_view type, const MessageDefinitions& definitions);

// What tells others of these hashes in an endpoint's user data, as Iron and newer read it; of a message,
// and of the service that it belongs to (from Lyrical on). Nothing of those that are empty, but never nothing at all:
// nodes on rmw_cyclonedds of Jazzy warn of each endpoint that says nothing. Other culprits know it as ours: that we
// say so is no sign of what the robot's nodes are (context.h).
std::string type_user_data(std::string_view hash, std::string_view service_hash = {});
// Whether that is a culprit's.
bool is_of_culprit(std::string_view user_data);

// What a node said of a type and of all types in it. Errors: it says what no definition could.
Expected<MessageDefinitions> to_definitions(const msg::TypeDescription& description);
// The reverse, with the same precondition as type_hash().
msg::TypeDescription describe(std::string_view type, const MessageDefinitions& definitions);

}  // namespace culprit::ros2
