#include "rtps/udp_sockets.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace culprit::rtps {
namespace {

// "0100007F:1CF2" is 127.0.0.1, port 7410: four bytes at a time, as the machine keeps them. For
// IPv6 the last four count: an IPv4 address inside one, or none.
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

// Takes the next of the columns that blanks part.
std::string_view next_column(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  const std::string_view column = line.substr(0, line.find(' '));
  line.remove_prefix(column.size());
  return column;
}

std::optional<UdpSocket> parse_socket(std::string_view line) {
  constexpr int kBetweenAddressAndUser = 5;
  constexpr int kBetweenUserAndInode = 1;
  UdpSocket socket;
  next_column(line);  // its number
  const auto address = parse_address(next_column(line));
  for (int i = 0; i < kBetweenAddressAndUser; ++i) next_column(line);
  const std::string_view user = next_column(line);
  for (int i = 0; i < kBetweenUserAndInode; ++i) next_column(line);
  const std::string_view inode = next_column(line);
  const auto read = std::from_chars(user.data(), user.data() + user.size(), socket.user);
  if (!address || read.ec != std::errc() || inode.empty()) return std::nullopt;
  socket.address = *address;
  socket.link = "socket:[" + std::string(inode) + "]";
  return socket;
}

void add_sockets(const std::filesystem::path& table, bool are_ipv6,
                 std::vector<UdpSocket>& sockets) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);  // the headings
  while (std::getline(file, line)) {
    auto socket = parse_socket(line);
    if (!socket) continue;
    socket->is_ipv6 = are_ipv6;
    sockets.push_back(std::move(*socket));
  }
}

}  // namespace

std::vector<UdpSocket> udp_sockets(const std::filesystem::path& proc) {
  std::vector<UdpSocket> sockets;
  std::error_code error;
  const std::filesystem::path own = proc / "thread-self/net";
  const std::filesystem::path tables = std::filesystem::exists(own, error) ? own : proc / "net";
  add_sockets(tables / "udp", false, sockets);
  add_sockets(tables / "udp6", true, sockets);
  return sockets;
}

std::set<std::uint16_t> bound_udp_ports() {
  std::set<std::uint16_t> ports;
  for (const UdpSocket& each : udp_sockets()) ports.insert(each.address.port);
  return ports;
}

}  // namespace culprit::rtps
