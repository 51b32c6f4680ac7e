#include "ros2/helper_endpoint.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

// The reader of a helper that takes samples in turn.
constexpr std::uint32_t kLeastDepth = 16;

std::int64_t to_nanoseconds(Duration duration) {
  return duration == rtps::kInfinite ? 0 : std::int64_t{duration.count()};
}

culprit_link::Quality to_quality(const rtps::Qos& qos) {
  culprit_link::Quality quality;
  quality.is_reliable = qos.reliability == rtps::Reliability::kReliable;
  quality.is_transient_local = qos.durability == rtps::Durability::kTransientLocal;
  quality.keeps_all = qos.history == rtps::History::kKeepAll;
  quality.depth = std::max(qos.depth, kLeastDepth);
  quality.lifespan = to_nanoseconds(qos.lifespan);
  return quality;
}

}  // namespace

std::optional<HelperEndpoint::Meaning> HelperEndpoint::meaning_of(const std::string& topic,
                                                                  const std::string& type) {
  if (topic == kDiscoveryInfoTopic) return Meaning{Purpose::kInfos, topic, type};
  if (type.starts_with("culprit::")) return Meaning{Purpose::kOwn, topic, type};
  const auto channel = demangle_topic(topic);
  if (!channel) return std::nullopt;
  const auto name = demangle_type(channel->channel, type);
  if (!name) return std::nullopt;
  const Purpose purpose = channel->channel == Channel::kTopic     ? Purpose::kTopic
                          : channel->channel == Channel::kRequest ? Purpose::kRequest
                                                                  : Purpose::kReply;
  return Meaning{purpose, channel->name, *name};
}

std::optional<culprit_link::Frame> HelperEndpoint::asks_for(const rtps::Qos& qos) const {
  const std::string& name = meaning.name;
  const std::string& type = meaning.type;
  const culprit_link::Quality quality = to_quality(qos);
  if (meaning.purpose == Purpose::kTopic && reads()) {
    const std::uint32_t most = is_whole(use)
                                   ? culprit_link::kWhole
                                   : static_cast<std::uint32_t>(given_of(use, kBeginningSize));
    return culprit_link::Subscribe{id, name, type, quality, most};
  }
  if (meaning.purpose == Purpose::kTopic) return culprit_link::Advertise{id, name, type, quality};
  // The other half of each, the reply, belongs to the request's.
  if (meaning.purpose == Purpose::kRequest && reads())
    return culprit_link::Offer{id, name, type, quality};
  if (meaning.purpose == Purpose::kRequest) return culprit_link::Use{id, name, type, quality};
  return std::nullopt;
}

void HelperEndpoint::deliver(rtps::ByteView payload, const rtps::SampleIdentity& identity,
                             const rtps::SampleIdentity& related) {
  gate.pass([&] {
    const rtps::SystemTime now = std::chrono::system_clock::now();
    on_sample({.payload = payload,
               .size = payload.size(),
               .sent = now,
               .received = now,
               .identity = identity,
               .related = related});
  });
}

void HelperEndpoint::match(const std::set<rtps::Guid>& now) {
  if (matched == now) return;
  const std::set<rtps::Guid> before = std::exchange(matched, now);
  gate.pass([&] {
    for (const rtps::Guid& each : before) {
      if (!now.contains(each) && on_match) on_match(each, Match::kLost);
    }
    for (const rtps::Guid& each : now) {
      if (before.contains(each)) continue;
      newest = each;
      if (on_match) on_match(each, Match::kMade);
    }
  });
}

rtps::Guid HelperEndpoint::newest_of(const std::set<rtps::Guid>& servers) const {
  return servers.contains(newest) ? newest : *servers.begin();
}

std::int64_t HelperEndpoint::count(const rtps::Guid& writer) {
  constexpr std::size_t kMostWriters = 1000;  // the network decides how many there are
  if (counted.size() >= kMostWriters) counted.clear();
  return ++counted[writer];
}

}  // namespace culprit::ros2
