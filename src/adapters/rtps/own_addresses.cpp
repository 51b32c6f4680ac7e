#include "rtps/own_addresses.h"

#include <cstring>
#include <ifaddrs.h>
#include <memory>
#include <netinet/in.h>

namespace culprit::rtps {

std::set<std::array<std::uint8_t, 4>> own_addresses() {
  std::set<std::array<std::uint8_t, 4>> own{{127, 0, 0, 1}};
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return own;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, &freeifaddrs);
  for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(i->ifa_addr);
    std::array<std::uint8_t, 4> ip{};
    std::memcpy(ip.data(), &address->sin_addr, ip.size());
    own.insert(ip);
  }
  return own;
}

}  // namespace culprit::rtps
