// Discovery data of other participants: their messages on ros_discovery_info, and any sequence of
// discovery events.
//
// The input is a list of events, each a kind, a participant, an endpoint, a length and so many
// bytes. The sum of the graph's notifications must equal its state, and its size must stay within
// its limits.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>
#include <tuple>

#include "link/manager_lease.h"
#include "ros2/discovery_info.h"
#include "ros2/graph.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;

constexpr Graph::Limits kLimits{.participants = 3, .nodes = 5, .endpoints = 8};

void require(bool condition) {
  if (!condition) std::abort();
}

rtps::Guid guid_of(std::uint8_t participant, std::uint8_t entity) {
  rtps::Guid guid;
  guid.bytes[0] = participant % 5;
  guid.bytes[14] = entity / 2;
  guid.bytes[15] = entity % 2 == 0 ? 4 : 3;
  return guid;
}

// Keeps the books on the graph's notifications.
class Books {
 public:
  void enter(const GraphChange& change) {
    if (const auto* joined = std::get_if<NodeJoined>(&change)) {
      require(nodes_.insert(joined->node.name).second);
    } else if (const auto* left = std::get_if<NodeLeft>(&change)) {
      require(nodes_.erase(left->node) == 1);
    } else if (const auto* appeared = std::get_if<EndpointJoined>(&change)) {
      require(nodes_.contains(appeared->node));
      require(
          edges_.insert({appeared->node, appeared->endpoint.kind, appeared->endpoint.name}).second);
    } else if (const auto* vanished = std::get_if<EndpointLeft>(&change)) {
      require(edges_.erase({vanished->node, vanished->kind, vanished->name}) == 1);
    }
  }
  void compare(const Graph& graph) const {
    std::size_t edges = 0;
    for (const Graph::NodeView& view : graph.nodes()) {
      require(nodes_.contains(view.node.name));
      edges += view.endpoints.size();
    }
    require(graph.nodes().size() == nodes_.size() && nodes_.size() <= kLimits.nodes);
    require(edges == edges_.size() && edges <= kLimits.endpoints);
  }

 private:
  std::set<std::string> nodes_;
  std::set<std::tuple<std::string, EndpointKind, std::string>> edges_;
};

void apply_info(Graph& graph, std::uint8_t participant, rtps::ByteView payload) {
  auto info = decode_discovery_info(payload);
  if (!info) return;
  const GidSize size = gid_size_of(payload);
  require(decode_discovery_info(encode_discovery_info(*info, size)) == info);
  // Let its claims be of endpoints that can exist here.
  info->participant = guid_of(participant, 0);
  for (NodeEntities& node : info->nodes) {
    for (auto* guids : {&node.readers, &node.writers}) {
      for (rtps::Guid& guid : *guids) guid = guid_of(participant, guid.bytes[15]);
    }
  }
  graph.apply(*info);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Books books;
  Graph::Options options;
  options.listener = [&](const GraphChange& change) { books.enter(change); };
  options.limits = kLimits;
  Graph graph(options);
  link::ManagerLease lease({.robot = "robot", .since = 1'000'000, .id = 1, .key = "key"},
                           guid_of(1, 0).prefix());
  Time now(std::chrono::hours(1));
  while (size >= 4) {
    const std::uint8_t kind = data[0], participant = data[1], entity = data[2];
    const std::size_t length = std::min<std::size_t>(data[3], size - 4);
    const rtps::ByteView bytes(data + 4, length);
    const std::string text(bytes.begin(), bytes.end());
    const rtps::Guid guid = guid_of(participant, entity);
    now += std::chrono::milliseconds(kind);
    switch (kind % 8) {
      case 0:
        graph.apply(ParticipantInfo{.guid = guid_of(participant, 0), .host = text});
        break;
      case 1:
        graph.apply(ParticipantGone{guid_of(participant, 0)});
        break;
      case 2:
        graph.apply(
            rtps::EndpointInfo{.guid = guid, .topic = "rt/" + text, .type = "a::msg::dds_::B_"});
        break;
      case 3:
        graph.apply(rtps::EndpointInfo{.guid = guid, .topic = text, .type = text});
        break;
      case 4:
        graph.apply(rtps::EndpointGone{guid});
        break;
      case 5:
        apply_info(graph, participant, bytes);
        break;
      case 6:
        lease.apply(
            rtps::EndpointInfo{
                .guid = guid, .topic = link::ManagerLease::kTopic, .type = "", .user_data = text},
            now);
        break;
      case 7:
        lease.hear(guid.prefix(), text, now);
        break;
    }
    data += 4 + length;
    size -= 4 + length;
  }
  books.compare(graph);
  (void)lease.elder(now);
  (void)lease.strangers();
  return 0;
}
