// Frames of a helper program: any bytes as frames, and each graph in them as discovery.
//
// A frame that was read is written and read again as the same. The graph that is fed with what a helper graph makes of
// any graphs stays consistent with itself.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <variant>

#include "culprit_link/protocol.h"
#include "ros2/graph.h"
#include "ros2/helper_graph.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit::ros2;
  if (size == 0) return 0;
  HelperGraph helper;
  helper.begin(data[0] % 2 == 0 ? "rmw_fastrtps_cpp" : "rmw_zenoh_cpp", {}, "/culprit");
  Graph::Options options;
  options.listener = [](const GraphChange&) {};
  Graph graph(options);
  culprit_link::FrameReader reader;
  reader.feed({data + 1, size - 1});
  while (const auto frame = reader.next()) {
    culprit_link::FrameReader again;
    again.feed(culprit_link::encode(*frame));
    require(again.next() == frame);
    const auto* seen = std::get_if<culprit_link::GraphSeen>(&*frame);
    if (seen == nullptr) continue;
    const auto missing =
        data[0] % 3 == 0 ? HelperGraph::Missing::kKeep : HelperGraph::Missing::kLeft;
    for (const HelperGraph::Change& change : helper.take(*seen, missing)) {
      if (const auto* event = std::get_if<DiscoveryEvent>(&change)) graph.apply(*event);
      if (const auto* info = std::get_if<DiscoveryInfo>(&change)) graph.apply(*info);
    }
    require(helper.take(*seen, missing).empty());
  }
  return 0;
}
