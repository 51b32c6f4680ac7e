#include "ros2/domain_lock.h"

#include <algorithm>
#include <set>
#include <string>

#include "rtps/udp_sockets.h"

namespace culprit::ros2 {
namespace {

// Whether any participant listens at the ports of the domain (RTPS 2.3 §9.6.1.1).
bool is_in_use(std::uint32_t domain, const std::set<std::uint16_t>& bound) {
  constexpr unsigned kBase = 7400;
  constexpr unsigned kGain = 250;
  return std::ranges::any_of(bound, [&](unsigned port) {
    return port >= kBase + kGain * domain && port < kBase + kGain * (domain + 1);
  });
}

}  // namespace

Expected<DomainLock> DomainLock::reserve(std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    auto lock = NamedLock::take("culprit-domain-" + std::to_string(domain));
    if (!lock) return Error{lock.error()};
    if (*lock && !is_in_use(domain, rtps::bound_udp_ports()))
      return DomainLock(std::move(**lock), domain);
  }
  if (first == last)
    return Error{"nodes run on the DDS domain " + std::to_string(first) +
                 " of this machine already; end them, or take another domain"};
  return Error{"all DDS domains from " + std::to_string(first) + " to " + std::to_string(last) +
               " are in use on this machine"};
}

}  // namespace culprit::ros2
