// A reader or writer of culprit's whose samples go through a helper program (helper_participant.h): what its DDS topic
// means there, what the helper makes for it, and how its owner is told of samples and matches.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "base/time.h"
#include "culprit_link/protocol.h"
#include "ros2/gate.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

struct HelperEndpoint {
  // The meaning of a DDS topic to a helper.
  enum class Purpose : std::uint8_t {
    kTopic,
    kRequest,
    kReply,
    kOwn,   // of the package `culprit`: to the helper and back
    kInfos  // ros_discovery_info
  };
  struct Meaning {
    Purpose purpose = Purpose::kTopic;
    std::string name;  // of the topic or service
    std::string type;  // "package/srv/Type"
  };
  // Nothing: it is no topic of ROS 2.
  static std::optional<Meaning> meaning_of(const std::string& topic, const std::string& type);

  bool reads() const { return role == rtps::EndpointRole::kReader; }
  bool reads(Purpose purpose, const std::string& name) const {
    return reads() && meaning.purpose == purpose && meaning.name == name;
  }
  // Returns the frame that asks a helper to make it, if it needs anything.
  std::optional<culprit_link::Frame> asks_for(const rtps::Qos& qos) const;

  // Only the thread that talks to the helper calls these.
  void deliver(rtps::ByteView payload, const rtps::SampleIdentity& identity,
               const rtps::SampleIdentity& related);
  void match(const std::set<rtps::Guid>& now);
  // Returns the one of `servers` that matched last. Not empty.
  rtps::Guid newest_of(const std::set<rtps::Guid>& servers) const;
  // Numbers the samples of a writer whose middleware does not.
  std::int64_t count(const rtps::Guid& writer);

  std::uint32_t id = 0;
  rtps::Guid guid;
  rtps::EndpointRole role = rtps::EndpointRole::kReader;
  Meaning meaning;
  std::string topic;                        // as DDS has it
  std::optional<culprit_link::Frame> wish;  // what asks_for() gave
  PayloadUse use = PayloadUse::kWhole;
  SampleCallback on_sample;  // of a reader
  MatchCallback on_match;    // may be empty
  Gate gate;

  // Only the thread that talks to the helper uses these.
  std::set<rtps::Guid> matched;
  rtps::Guid newest{};        // of those, that which matched last
  Time came_last = kLongAgo;  // a sample
  // Samples of writers that the middleware does not count.
  std::map<rtps::Guid, std::int64_t> counted;
};

}  // namespace culprit::ros2
