#include "doctor/nodes_to_ask.h"

#include <algorithm>
#include <map>
#include <set>

namespace culprit::doctor {
namespace {

bool is_managed(const ros2::Graph::NodeView& view) {
  return std::ranges::any_of(view.endpoints, [&](const ros2::GraphEndpoint& each) {
    return each.kind == EndpointKind::kServer && each.name == view.node.name + "/get_state";
  });
}

}  // namespace

std::vector<ros2::Graph::NodeView> nodes_to_ask(std::vector<ros2::Graph::NodeView> nodes,
                                                std::size_t round) {
  constexpr std::size_t kMost = 60;
  if (nodes.size() <= kMost) return nodes;
  std::map<rtps::GuidPrefix, std::vector<std::size_t>> by_participant;
  std::vector<std::size_t> managed;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    by_participant[nodes[i].participant].push_back(i);
    if (is_managed(nodes[i])) managed.push_back(i);
  }
  std::set<std::size_t> chosen;
  for (const auto& each : by_participant) chosen.insert(each.second[round % each.second.size()]);
  // So many at least have room in each round.
  const std::size_t step = kMost - std::min(kMost, by_participant.size());
  for (std::size_t i = 0; i < managed.size() && chosen.size() < kMost; ++i)
    chosen.insert(managed[(round * step + i) % managed.size()]);
  std::vector<ros2::Graph::NodeView> views;
  for (const std::size_t i : chosen) views.push_back(std::move(nodes[i]));
  return views;
}

}  // namespace culprit::doctor
