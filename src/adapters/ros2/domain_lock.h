// A DDS domain of one's own, so that two tests or two demonstrations on one machine do not discover
// each other. The lock is the name "culprit-domain-<n>"; a domain that somebody on this machine
// listens in, lock or not, is no longer free either.
#pragma once

#include <cstdint>

#include "ros2/named_lock.h"

namespace culprit::ros2 {

class DomainLock {
 public:
  static constexpr std::uint32_t kFirst = 1;  // 0 is where robots are
  static constexpr std::uint32_t kLast = 100;

  // The first free domain from `first` to `last`. An error when none is.
  static Expected<DomainLock> reserve(std::uint32_t first = kFirst, std::uint32_t last = kLast);

  std::uint32_t domain() const { return domain_; }

 private:
  DomainLock(NamedLock lock, std::uint32_t domain) : lock_(std::move(lock)), domain_(domain) {}

  NamedLock lock_;
  std::uint32_t domain_;
};

}  // namespace culprit::ros2
