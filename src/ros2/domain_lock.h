// A DDS domain of one's own, so that two tests or two demonstrations on one machine do not hear
// each other.
//
// The lock is the abstract Unix socket "culprit-domain-<n>", which the kernel gives to one process
// only and frees when that process ends, however it ends. There is no file to clean up.
#pragma once

#include <cstdint>

#include "language/expected.h"

namespace culprit::ros2 {

class DomainLock {
 public:
  static constexpr std::uint32_t kFirst = 1;  // 0 is where robots are
  static constexpr std::uint32_t kLast = 100;

  // The first free domain from `first` to `last`. An error when all are taken.
  static Expected<DomainLock> reserve(std::uint32_t first = kFirst, std::uint32_t last = kLast);

  DomainLock(DomainLock&& other) noexcept;
  DomainLock& operator=(DomainLock&& other) noexcept;
  ~DomainLock();

  std::uint32_t domain() const { return domain_; }

 private:
  DomainLock(int socket, std::uint32_t domain) : socket_(socket), domain_(domain) {}

  int socket_;  // -1 after a move
  std::uint32_t domain_;
};

}  // namespace culprit::ros2
