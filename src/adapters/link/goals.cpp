#include "link/goals.h"

#include <algorithm>

#include "ros2/messages.h"

namespace culprit::link {

std::optional<GoalsSeen> goals_in(TopicId topic, rtps::ByteView payload) {
  constexpr std::size_t kMost = 1000;  // the network decides how many there are
  const auto message = rtps::decode<ros2::msg::GoalStatusArray>(payload);
  if (!message) return std::nullopt;
  GoalsSeen seen{topic, {}};
  const auto& all = message->status_list;
  for (std::size_t i = all.size() - std::min(all.size(), kMost); i < all.size(); ++i) {
    // Half of a UUID is as good as all of it: no server has so many goals.
    std::uint64_t id = 0;
    for (std::size_t byte = 0; byte < 8; ++byte)
      id = id << 8 | (all[i].goal_info.goal_id[byte] ^ all[i].goal_info.goal_id[byte + 8]);
    const bool is_known = all[i].status >= 0 && all[i].status <= 6;
    seen.goals.push_back({id, is_known ? GoalStatus(all[i].status) : GoalStatus::kUnknown});
  }
  return seen;
}

}  // namespace culprit::link
