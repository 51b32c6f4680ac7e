#include "doctor/nodes_to_ask.h"

#include <algorithm>
#include <map>

namespace culprit::doctor {

std::vector<ros2::Graph::NodeView> nodes_to_ask(std::vector<ros2::Graph::NodeView> nodes,
                                                std::size_t round) {
  constexpr std::size_t kMost = 60;
  if (nodes.size() <= kMost) return nodes;
  std::map<ros2::GuidPrefix, std::vector<ros2::Graph::NodeView>> by_participant;
  for (auto& view : nodes) by_participant[view.participant].push_back(std::move(view));
  std::vector<ros2::Graph::NodeView> chosen;
  for (std::size_t turn = 0; turn == 0 || chosen.size() < kMost; ++turn) {
    bool is_left = false;
    for (const auto& [participant, its] : by_participant) {
      const bool has_room = turn == 0 || chosen.size() < kMost;
      if (turn >= its.size() || !has_room) continue;
      is_left = true;
      chosen.push_back(its[(round + turn) % its.size()]);
    }
    if (!is_left) break;
  }
  return chosen;
}

}  // namespace culprit::doctor
