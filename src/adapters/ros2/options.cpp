#include "ros2/options.h"

#include <algorithm>
#include <arpa/inet.h>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <string_view>

#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

constexpr std::uint32_t kLastDomain =
    232;  // the last one whose ports are below 65536 (RTPS 2.3 §9.6.1.1)

std::string_view value_of(const Environment& get, const char* name) {
  const char* value = get(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

Error bad_value(const char* name, std::string_view value, const std::string& what) {
  return Error{std::string(name) + " is '" + printable(value) + "'; " + what};
}

Expected<std::uint32_t> read_domain(std::string_view text) {
  std::uint32_t domain = 0;
  if (text.empty()) return domain;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, domain);
  if (error != std::errc() || rest != end || domain > kLastDomain) {
    return bad_value("ROS_DOMAIN_ID", text,
                     "a domain is a number from 0 to 232, better not above 101");
  }
  return domain;
}

Expected<Reach> read_reach(const Environment& get) {
  constexpr const char* kLocalhostOnly = "ROS_LOCALHOST_ONLY";
  constexpr const char* kRange = "ROS_AUTOMATIC_DISCOVERY_RANGE";
  const auto localhost_only = value_of(get, kLocalhostOnly);
  if (localhost_only == "1") return Reach::kLocalhost;
  if (!localhost_only.empty() && localhost_only != "0") {
    return bad_value(kLocalhostOnly, localhost_only, "it is either 0 or 1");
  }
  const auto range = value_of(get, kRange);
  if (range == "LOCALHOST") return Reach::kLocalhost;
  if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") return Reach::kSubnet;
  if (range == "OFF")
    return bad_value(kRange, range, "nothing can be discovered; use SUBNET or LOCALHOST");
  return bad_value(kRange, range, "it is SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
}

// "192.168.1.5:11811;;UDPv4:[robot.local]:11888": the place in the list is the server's number.
Expected<std::vector<DiscoveryServer>> read_servers(std::string_view all) {
  constexpr const char* kServers = "ROS_DISCOVERY_SERVER";
  constexpr std::uint16_t kUsualPort = 11811;
  constexpr std::string_view kUdp = "UDPv4:";
  std::vector<DiscoveryServer> servers;
  std::string_view left = all;
  for (std::size_t id = 0; !left.empty(); ++id) {
    const auto end = std::min(left.find(';'), left.size());
    std::string_view text = left.substr(0, end);
    left.remove_prefix(std::min(end + 1, left.size()));
    if (text.empty()) continue;
    if (id > 255) return bad_value(kServers, all, "it has places for 256 servers");
    const std::string_view written = text;
    if (text.starts_with(kUdp)) text.remove_prefix(kUdp.size());
    DiscoveryServer server{static_cast<std::uint8_t>(id), "", kUsualPort};
    const auto close = text.starts_with('[') ? text.find(']') : std::string_view::npos;
    const auto colon = text.find(':', close == std::string_view::npos ? 0 : close);
    if (colon != std::string_view::npos) {
      const auto port = text.substr(colon + 1);
      const auto [rest, error] =
          std::from_chars(port.data(), port.data() + port.size(), server.port);
      if (error != std::errc() || rest != port.data() + port.size() || server.port == 0)
        return bad_value(kServers, written, "write a server as address:port, reached by UDPv4");
      text = text.substr(0, colon);
    }
    server.host = close == std::string_view::npos ? text : text.substr(1, close - 1);
    if (server.host.empty() || server.host.find(':') != std::string::npos)
      return bad_value(kServers, written, "write a server as address:port, reached by UDPv4");
    servers.push_back(std::move(server));
  }
  return servers;
}

}  // namespace

Expected<ParticipantOptions> options_from_environment(const Environment& get) {
  ParticipantOptions options;
  const auto domain = read_domain(value_of(get, "ROS_DOMAIN_ID"));
  if (!domain) return Error{domain.error()};
  options.domain = *domain;
  const auto reach = read_reach(get);
  if (!reach) return Error{reach.error()};
  options.reach = *reach;

  std::string_view peers = value_of(get, "ROS_STATIC_PEERS");
  while (!peers.empty()) {
    const auto end = std::min(peers.find(';'), peers.size());
    if (end > 0) options.peers.emplace_back(peers.substr(0, end));
    peers.remove_prefix(std::min(end + 1, peers.size()));
  }
  auto servers = read_servers(value_of(get, "ROS_DISCOVERY_SERVER"));
  if (!servers) return Error{servers.error()};
  options.servers = std::move(*servers);
  auto security = security_from_environment(get);
  if (!security) return Error{security.error()};
  options.security = std::move(*security);
  if (options.security) options.enclave = options.security->enclave;
  return options;
}

Expected<ParticipantOptions> options_from_environment() {
  return options_from_environment(
      [](const char* name) -> const char* { return std::getenv(name); });
}

Expected<std::string> resolve_peer(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0) {
    return Error{"the peer '" + printable(host) + "' cannot be found: " + gai_strerror(error)};
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, &freeaddrinfo);
  std::array<char, INET_ADDRSTRLEN> text{};
  const auto* address = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
  return std::string(text.data());
}

}  // namespace culprit::ros2
