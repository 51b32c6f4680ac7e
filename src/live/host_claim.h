// Which of several culprits on one machine is in charge of something: of a robot, or of a node.
//
// A claim is a name that the kernel gives to one process at a time (ros2/named_lock.h). Any user of
// the machine can take such a name, so a claim counts only if the kernel says that its process
// belongs to our own user, or to root. Root's culprit goes first. Any other holder of the name is
// reported and ignored.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ros2/named_lock.h"

namespace culprit::live {

class HostClaim {
 public:
  // `name`: what is claimed, the same for all culprits.
  explicit HostClaim(std::string name) : name_(std::move(name)) {}

  // Looks anew. Returns whether it is ours: no other entitled process has it.
  bool look();
  // The holder, "process 123"; empty while the claim is ours.
  const std::string& holder() const { return holder_; }
  // Its process; 0: in another container.
  int holder_pid() const { return holder_pid_; }
  // A process that has no right to the name and keeps it from us; empty: there is none.
  const std::string& stranger() const { return stranger_; }

 private:
  std::string name_for(std::uint32_t user) const;

  std::string name_;
  std::optional<ros2::NamedLock> lock_;
  std::optional<ros2::NamedLock::Holder> known_;  // who was found to have our user's name
  std::string holder_;
  int holder_pid_ = 0;
  std::string stranger_;
};

}  // namespace culprit::live
