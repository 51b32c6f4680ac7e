// Describes a message type and hashes the description, as ROS 2 Iron and newer announce it for
// every endpoint (REP 2011, "RIHS01"): the SHA-256 of the fields of the type and of all types in
// it. Two programs that announce the same hash mean the same type, whatever their files contain.
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

// An endpoint's user data that announces these hashes, as Iron and newer read it: of a message, and
// of the service that it belongs to (from Lyrical on). Empty hashes are left out, but the user data
// is never empty: nodes on rmw_cyclonedds of Jazzy warn of each endpoint without user data. Other
// culprits recognize it as ours, and so do not infer from it which ROS version the robot's nodes
// use (context.h).
std::string type_user_data(std::string_view hash, std::string_view service_hash = {});
// Whether that is a culprit's.
bool is_of_culprit(std::string_view user_data);

// The definitions of a type and of all types in it, from a node's description. Errors: no
// definition could have this description.
Expected<MessageDefinitions> to_definitions(const msg::TypeDescription& description);
// The reverse, with the same precondition as type_hash().
msg::TypeDescription describe(std::string_view type, const MessageDefinitions& definitions);

}  // namespace culprit::ros2
