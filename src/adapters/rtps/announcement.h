// Decodes a participant's announcements of its readers and writers (RTPS 2.3 §8.5.4.3). They are
// lists of parameters, each a number, a length and a value of so many bytes (§9.4.2.11), the
// numbers in §9.6.2.2.2.
//
// The middleware reads the same lists. These functions are for announcements that it does not
// receive (datagram_filter.h). They give the same result as the middleware's: omitted parameters
// have the same defaults. They never read outside of their bytes.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "rtps/cdr.h"
#include "rtps/endpoint_info.h"

namespace culprit::rtps {

// `payload` starts with its encapsulation. Nothing: there is no topic, or the list is damaged before it.
std::optional<std::string_view> announced_topic(ByteView payload);

// Nothing: the list is damaged or incomplete, or not of an endpoint of this role.
std::optional<EndpointInfo> read_announcement(ByteView payload, EndpointRole role);

// Which endpoint ends. `parameters` are those of its submessage, whose order of bytes this is; `payload` is
// its key, with its encapsulation, and may be empty. Nothing: none ends, or none is named.
std::optional<Guid> read_end(ByteView parameters, Endianness order, ByteView payload);

// The participants and endpoints that are announced, or have ended: every key that the middleware may find in the lists,
// also in damaged ones. `parameters` and `payload` as above.
std::vector<Guid> announced_keys(ByteView parameters, Endianness order, ByteView payload);

// The datagram by which the participant announces that it has left, as Fast DDS writes it, with the
// number `sequence`.
Bytes farewell_of(const GuidPrefix& participant, std::int64_t sequence);

}  // namespace culprit::rtps
