#include "ros2/domain_lock.h"

#include <charconv>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace culprit::ros2 {
namespace {

// The UDP ports that are bound on this machine.
std::set<unsigned> bound_ports() {
  std::set<unsigned> ports;
  for (const char* table : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);  // the headings
    while (std::getline(file, line)) {
      std::istringstream columns(line);
      std::string number, local;
      columns >> number >> local;
      const std::size_t colon = local.find(':');
      if (colon == std::string::npos) continue;
      unsigned port = 0;
      std::from_chars(local.data() + colon + 1, local.data() + local.size(), port, 16);
      ports.insert(port);
    }
  }
  return ports;
}

// Whether any participant listens at the ports of the domain (RTPS 2.3 §9.6.1.1).
bool is_in_use(std::uint32_t domain, const std::set<unsigned>& bound) {
  constexpr unsigned kBase = 7400;
  constexpr unsigned kGain = 250;
  const auto first = bound.lower_bound(kBase + kGain * domain);
  return first != bound.end() && *first < kBase + kGain * (domain + 1);
}

}  // namespace

Expected<DomainLock> DomainLock::reserve(std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t domain = first; domain <= last; ++domain) {
    auto lock = NamedLock::take("culprit-domain-" + std::to_string(domain));
    if (!lock) return Error{lock.error()};
    if (*lock && !is_in_use(domain, bound_ports())) return DomainLock(std::move(**lock), domain);
  }
  if (first == last)
    return Error{"nodes run on the DDS domain " + std::to_string(first) +
                 " of this machine already; end them, or take another domain"};
  return Error{"all DDS domains from " + std::to_string(first) + " to " + std::to_string(last) +
               " are in use on this machine"};
}

}  // namespace culprit::ros2
