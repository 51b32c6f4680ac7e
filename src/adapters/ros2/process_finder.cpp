#include "ros2/process_finder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <system_error>

#include "rtps/own_addresses.h"
#include "rtps/process_sockets.h"
#include "rtps/udp_sockets.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

bool is_local(const std::array<std::uint8_t, 4>& ip) {
  return ip[0] == 127 || own_addresses().contains(ip);
}

// The sockets that one address may belong to: several where they share a port.
using Candidates = std::vector<UdpSocket>;

Candidates bound_to(const UdpAddress& address, const std::vector<UdpSocket>& sockets) {
  Candidates found;
  for (const UdpSocket& socket : sockets) {
    const bool fits =
        socket.address.ip == std::array<std::uint8_t, 4>{} || socket.address.ip == address.ip;
    if (fits && socket.address.port == address.port) found.push_back(socket);
  }
  return found;
}

// Who it runs as: the real and the effective user.
std::vector<unsigned> users_of(const fs::path& process) {
  std::ifstream file(process / "status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("Uid:")) continue;
    std::istringstream columns(line.substr(4));
    unsigned real = 0, effective = 0;
    if (columns >> real >> effective) return {real, effective};
  }
  return {};
}

bool holds(const fs::path& process, const std::vector<Candidates>& needed) {
  const std::set<std::string> links = descriptors_of(process);
  if (links.empty()) return false;
  const std::vector<unsigned> users = users_of(process);
  const auto is_its = [&](const UdpSocket& socket) {
    return links.contains(socket.link) &&
           std::find(users.begin(), users.end(), socket.user) != users.end();
  };
  return std::all_of(needed.begin(), needed.end(), [&](const Candidates& each) {
    return std::any_of(each.begin(), each.end(), is_its);
  });
}

int to_pid(const fs::path& process) {
  const std::string name = process.filename().native();
  int pid = 0;
  const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), pid);
  return error == std::errc() && rest == name.data() + name.size() ? pid : 0;
}

// The latest if it cannot be told.
std::uint64_t began(const fs::path& process) { return running_since(process).value_or(UINT64_MAX); }

}  // namespace

ProcessFinder::ProcessFinder(fs::path proc) : proc_(std::move(proc)) {}

FoundProcess ProcessFinder::find(const ParticipantInfo& participant) const {
  std::vector<UdpAddress> addresses;
  bool may_be_elsewhere = false;
  for (const UdpAddress& each : participant.metatraffic) {
    if (is_local(each.ip)) {
      addresses.push_back(each);
    } else {
      may_be_elsewhere = true;
    }
  }
  if (addresses.empty()) return {};
  FoundProcess found = prove(participant, addresses, may_be_elsewhere);
  if (found.pid == 0 && !may_be_elsewhere) found.has_ended = has_ended(participant);
  return found;
}

// A participant keeps the sockets where it listens as long as it lives, and one that it sends from.
// A new process may get the first ones.
bool ProcessFinder::has_ended(const ParticipantInfo& participant) const {
  const std::vector<UdpAddress>& from = participant.origin.addresses;
  const auto is_here = [](const UdpAddress& each) { return is_local(each.ip); };
  if (!std::all_of(from.begin(), from.end(), is_here)) return false;
  const std::vector<UdpSocket> sockets = udp_sockets(proc_);
  if (sockets.empty()) return false;  // there is at least the one that this was heard by
  const auto is_nobodys = [&](const UdpAddress& each) { return bound_to(each, sockets).empty(); };
  return std::any_of(participant.metatraffic.begin(), participant.metatraffic.end(), is_nobodys) ||
         (participant.origin.is_complete && !from.empty() &&
          std::all_of(from.begin(), from.end(), is_nobodys));
}

FoundProcess ProcessFinder::prove(const ParticipantInfo& participant,
                                  std::vector<UdpAddress> addresses, bool may_be_elsewhere) const {
  if (!participant.origin.is_complete)
    return {0, participant.origin.addresses.empty()
                   ? "nothing is known of where its datagrams come from"
                   : "its datagrams come from more places than one process has"};
  for (const UdpAddress& each : participant.origin.addresses) {
    // Every machine with containers has the address of a bridge, and it is the same one.
    if (!is_local(each.ip) && may_be_elsewhere) return {};
    if (!is_local(each.ip))
      return {0, "it says that it is on this machine, but datagrams in its name come from " +
                     to_text(each)};
    addresses.push_back(each);
  }

  const std::vector<UdpSocket> sockets = udp_sockets(proc_);
  std::vector<Candidates> needed;
  for (const UdpAddress& each : addresses) {
    needed.push_back(bound_to(each, sockets));
    if (needed.back().empty())
      return {0, "no process of this machine has the socket " + to_text(each) +
                     " that it announces or sends from"};
  }

  // Forks of the process hold the same sockets: what it says helps to choose among those.
  if (participant.pid > 0 && holds(proc_ / std::to_string(participant.pid), needed))
    return {participant.pid, ""};
  int oldest = 0;
  std::error_code error;
  for (fs::directory_iterator i(proc_, error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const int pid = to_pid(i->path());
    if (pid <= 0 || !holds(i->path(), needed)) continue;
    if (oldest == 0 || began(i->path()) < began(proc_ / std::to_string(oldest))) oldest = pid;
  }
  if (oldest != 0) return {oldest, ""};
  std::string all;
  for (const UdpAddress& each : addresses) all += (all.empty() ? "" : ", ") + to_text(each);
  return {0, "no process whose files can be seen holds all of its sockets (" + all +
                 "); of another user's, culprit may see them only with CAP_SYS_PTRACE"};
}

bool ProcessFinder::is_running(int pid) const {
  return running_since(proc_ / std::to_string(pid)).has_value();
}

}  // namespace culprit::ros2
