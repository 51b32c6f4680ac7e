#include "ros2/process_finder.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <fstream>
#include <ifaddrs.h>
#include <memory>
#include <netinet/in.h>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

// As the link of a file descriptor shows a socket: "socket:[12345]".
using SocketLinks = std::set<std::string>;

bool is_local(const std::array<std::uint8_t, 4>& ip) {
  if (ip[0] == 127) return true;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return false;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, &freeifaddrs);
  for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    const auto* address = reinterpret_cast<const sockaddr_in*>(i->ifa_addr);
    if (std::memcmp(&address->sin_addr, ip.data(), ip.size()) == 0) return true;
  }
  return false;
}

std::string own_host() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

// Adds the sockets of a table such as /proc/net/udp that are bound to `port`.
void add_sockets(const fs::path& table, std::uint16_t port, SocketLinks& links) {
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);  // the headings
  while (std::getline(file, line)) {
    std::istringstream columns(line);
    std::string skipped, local, inode;
    columns >> skipped >> local;
    for (int i = 0; i < 7; ++i) columns >> skipped;
    columns >> inode;
    const auto colon = local.find(':');
    unsigned bound = 0;
    if (colon == std::string::npos) continue;
    std::from_chars(local.data() + colon + 1, local.data() + local.size(), bound, 16);
    if (bound == port) links.insert("socket:[" + inode + "]");
  }
}

enum class Holds : std::uint8_t { kYes, kNo, kHidden };

Holds holds(const fs::path& process, const SocketLinks& links) {
  std::error_code error;
  fs::directory_iterator files(process / "fd", error);
  if (error) return fs::exists(process, error) ? Holds::kHidden : Holds::kNo;
  while (files != fs::directory_iterator()) {
    const fs::path target = fs::read_symlink(files->path(), error);
    if (!error && links.contains(target.native())) return Holds::kYes;
    files.increment(error);
    if (error) break;  // the process went away meanwhile
  }
  return Holds::kNo;
}

int to_pid(const fs::path& process) {
  const std::string name = process.filename().native();
  int pid = 0;
  const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), pid);
  return error == std::errc() && rest == name.data() + name.size() ? pid : 0;
}

}  // namespace

ProcessFinder::ProcessFinder(fs::path proc) : proc_(std::move(proc)) {}

int ProcessFinder::find(const ParticipantInfo& participant) const {
  SocketLinks links;
  for (const UdpAddress& address : participant.metatraffic) {
    if (!is_local(address.ip)) continue;
    add_sockets(proc_ / "net/udp", address.port, links);
    add_sockets(proc_ / "net/udp6", address.port, links);
  }
  if (links.empty()) return 0;

  const Holds claimed =
      participant.pid > 0 ? holds(proc_ / std::to_string(participant.pid), links) : Holds::kNo;
  if (claimed == Holds::kYes) return participant.pid;
  std::error_code error;
  for (fs::directory_iterator i(proc_, error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const int pid = to_pid(i->path());
    if (pid > 0 && holds(i->path(), links) == Holds::kYes) return pid;
  }
  return claimed == Holds::kHidden && participant.host == own_host() ? participant.pid : 0;
}

}  // namespace culprit::ros2
