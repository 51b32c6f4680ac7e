// What culprit's own node is called: /culprit, so that people find it; where another culprit of this
// machine is called so on the same domain, /culprit_2, and so on. Two nodes of one name are told of as
// doubled by every tool, and services of one of them reach either.
//
// Where keys are used, what they permit is permitted to /culprit by name, and that is what it is called.
// Culprits of other machines are not seen before they are met: they are told of, and --node-name helps.
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
