// The two ways in which ROS 2 pairs a reply with its request on DDS.
//
// - In line (rmw_fastrtps): both payloads are just the messages. The request carries in its inline
//   QoS the GUID of the client's reply reader as related identity; the request's own sequence
//   number is its name; the reply carries both.
// - Header (rmw_cyclonedds): both payloads begin, after the encapsulation, with a number unique to
//   the client and the client's own count of requests. Sixteen bytes, so that the alignment of the
//   message stays as it was.
//
// The vendor of a node decides its way. One server can serve both kinds of client at once.
//
// Where Fast DDS meets Cyclone there is one more trap. Some peer may not acknowledge a sample of
// ours (a killed one does not until its lease ends). As long as that is so, Fast DDS first sends a
// new reader a heartbeat that announces its first sample. Cyclone takes what the first heartbeat
// announces for history, in which a volatile reader has no interest, and drops the sample. So a
// client drops its old requests when a new server comes. A server first sends a client on Cyclone a
// reply that is addressed to no client, and waits until that was acknowledged.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "ros2/participant.h"
#include "rtps/cdr.h"

namespace culprit::ros2 {

enum class Mapping : std::uint8_t { kInline, kHeader };

// `participant` may be null: one of our own, or one that is not known.
Mapping mapping_of(const ParticipantInfo* participant);

struct ServiceHeader {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  bool operator==(const ServiceHeader&) const = default;
};

rtps::Bytes with_header(rtps::ByteView payload, const ServiceHeader& header);

struct SplitPayload {
  ServiceHeader header;
  rtps::Bytes payload;
};
std::optional<SplitPayload> split_header(rtps::ByteView payload);

// The value of `key` in an endpoint's user data, "key=value;key=value;". Empty when it is not
// there. Cyclone marks the two endpoints of a client with one `clientid`, and those of a server
// with one `serviceid`.
std::string_view user_data_value(std::string_view user_data, std::string_view key);

// When each endpoint matched: the how manieth it was, from 1.
using Matches = std::map<rtps::Guid, std::uint64_t>;
// The participants that have a server: a reader of requests and a writer of replies with the same id, which may be empty. Two
// services of one name in one process can be distinguished only on Cyclone. The newest last. Strangers decide how many endpoints
// there are, so each is looked at once.
std::vector<rtps::GuidPrefix> servers_among(
    const Matches& request_readers, const Matches& reply_writers,
    const std::function<std::string_view(const rtps::Guid&)>& id_of);

}  // namespace culprit::ros2
