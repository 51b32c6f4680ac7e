// Which fields of a message type are numbers, as paths for FieldReader: what can be drawn of messages that nobody named a
// field of.
#pragma once

#include <string>
#include <vector>

#include "ros2/message_library.h"

namespace culprit::bag {

// In the order of the type, `most` of them at most: numbers and truths, also of messages in it ("twist.linear.x"), and the
// first few numbers of arrays of them ("position[0]"). Left out are texts, bytes in arrays, arrays of messages, and the
// stamps of messages (std_msgs/msg/Header and builtin_interfaces), which only tell the time. Empty: there are none, or the
// type is not known. Takes a bounded time, whatever the definition says.
std::vector<std::string> number_fields(ros2::MessageLibrary& library, const std::string& type,
                                       std::size_t most);

}  // namespace culprit::bag
