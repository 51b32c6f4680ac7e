#include "live/node_name.h"

namespace culprit::live {

NodeNameClaim::NodeNameClaim(const ros2::ParticipantOptions& participant) : name_("culprit") {
  constexpr int kMost = 100;  // anybody may take such names, and keep them
  if (participant.security) return;
  for (int number = 1; number <= kMost && !lock_; ++number) {
    const std::string name = number == 1 ? "culprit" : "culprit_" + std::to_string(number);
    auto taken = ros2::NamedLock::take("node-" + std::to_string(participant.domain) + "-" + name);
    if (!taken) return;
    if (!*taken) continue;
    lock_ = std::move(*taken);
    name_ = name;
  }
}

}  // namespace culprit::live
