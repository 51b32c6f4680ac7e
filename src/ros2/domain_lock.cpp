#include "ros2/domain_lock.h"

#include <string>

namespace culprit::ros2 {

Expected<DomainLock> DomainLock::reserve(std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    auto lock = NamedLock::take("culprit-domain-" + std::to_string(domain));
    if (!lock) return Error{lock.error()};
    if (*lock) return DomainLock(std::move(**lock), domain);
  }
  return Error{"all DDS domains from " + std::to_string(first) + " to " + std::to_string(last) +
               " are reserved by other culprit processes"};
}

}  // namespace culprit::ros2
