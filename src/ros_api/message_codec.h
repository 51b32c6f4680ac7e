// Messages as JSON documents, on the wire and back, by their definitions: their fields by name, numbers,
// booleans and texts as such, sequences as lists.
//
//     const auto payload = encode({{"summary", "all is well"}}, types.message("culprit_msgs/msg/Status"));
//     const auto request = decode(payload, types.service("culprit_msgs/srv/Pause").request);
#pragma once

#include "base/expected.h"
#include "json/json.h"
#include "ros_api/culprit_types.h"
#include "rtps/cdr.h"

namespace culprit::ros_api {

// A field that the document has not is zero, false or empty. Texts that are no UTF-8 are mended; a
// floating-point number that is null is not a number. Errors: a member that is no field of the type, or
// does not fit it.
Expected<rtps::Bytes> encode(const Json& document, const MessageType& type);

// Errors: the payload is no message of that type, or a text in it is no UTF-8.
Expected<Json> decode(rtps::ByteView payload, const MessageType& type);

}  // namespace culprit::ros_api
