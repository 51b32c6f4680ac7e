// The name of culprit's own node: /culprit, so that people find it. If another culprit of this machine has that name on the same domain, it is /culprit_2, and
// so on. Every tool reports two nodes of one name as duplicates, and a request to their services reaches either.
//
// Where keys are used, what they permit is permitted to /culprit by name, and that is what it is called.
// Culprits of other machines are only discovered later: they are reported, and --node-name helps.
#pragma once

#include <optional>
#include <string>

#include "ros2/named_lock.h"
#include "ros2/options.h"

namespace culprit::live {

class NodeNameClaim {
 public:
  // The first name that no other process of this machine has; it is kept as long as the claim lives.
  explicit NodeNameClaim(const ros2::ParticipantOptions& participant);

  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::optional<ros2::NamedLock> lock_;
};

}  // namespace culprit::live
