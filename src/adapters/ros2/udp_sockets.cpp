#include "ros2/udp_sockets.h"

#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

namespace culprit::ros2 {
namespace {

// "0100007F:1CF2" is 127.0.0.1, port 7410: four bytes at a time, as the machine keeps them. Of IPv6 the
// last four count: an IPv4 address inside one, or none.
std::optional<UdpAddress> parse_address(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos || colon < 8) return std::nullopt;
  std::uint32_t ip = 0;
  UdpAddress address;
  const char* begin = text.data() + colon - 8;
  if (std::from_chars(begin, begin + 8, ip, 16).ec != std::errc()) return std::nullopt;
  std::memcpy(address.ip.data(), &ip, address.ip.size());
  begin = text.data() + colon + 1;
  if (std::from_chars(begin, text.data() + text.size(), address.port, 16).ec != std::errc())
    return std::nullopt;
  return address;
}

void add_sockets(const std::filesystem::path& table, std::vector<UdpSocket>& sockets) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);  // the headings
  while (std::getline(file, line)) {
    std::istringstream columns(line);
    std::string skipped, local, inode;
    UdpSocket socket;
    columns >> skipped >> local;
    for (int i = 0; i < 5; ++i) columns >> skipped;
    columns >> socket.user >> skipped >> inode;
    const auto address = parse_address(local);
    if (!columns || !address) continue;
    socket.address = *address;
    socket.link = "socket:[" + inode + "]";
    sockets.push_back(std::move(socket));
  }
}

}  // namespace

std::vector<UdpSocket> udp_sockets(const std::filesystem::path& proc) {
  std::vector<UdpSocket> sockets;
  for (const char* table : {"net/udp", "net/udp6"}) add_sockets(proc / table, sockets);
  return sockets;
}

std::set<std::uint16_t> bound_udp_ports() {
  std::set<std::uint16_t> ports;
  for (const UdpSocket& each : udp_sockets()) ports.insert(each.address.port);
  return ports;
}

}  // namespace culprit::ros2
