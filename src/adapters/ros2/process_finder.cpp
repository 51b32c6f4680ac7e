#include "ros2/process_finder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <unistd.h>

#include "rtps/own_addresses.h"
#include "rtps/process_sockets.h"
#include "rtps/udp_sockets.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

bool is_local(const std::array<std::uint8_t, 4>& ip) {
  return ip[0] == 127 || rtps::own_addresses().contains(ip);
}

// The sockets that one address may belong to: several where they share a port.
struct Candidates {
  std::vector<rtps::UdpSocket> sockets;
  // One that other processes have, too, proves nothing: each of them may have sent what came from there.
  bool is_exclusive = false;
};

Candidates bound_to(const rtps::UdpAddress& address, const std::vector<rtps::UdpSocket>& sockets) {
  Candidates found;
  for (const rtps::UdpSocket& socket : sockets) {
    const bool fits = socket.address.ip == rtps::Ip{} || socket.address.ip == address.ip;
    if (fits && socket.address.port == address.port) found.sockets.push_back(socket);
  }
  return found;
}

Candidates sends_from(const rtps::UdpAddress& address,
                      const std::vector<rtps::UdpSocket>& sockets) {
  Candidates found = bound_to(address, sockets);
  found.is_exclusive = true;
  const auto is_ipv4 = [](const rtps::UdpSocket& each) { return !each.is_ipv6; };
  if (std::ranges::any_of(found.sockets, is_ipv4))
    std::erase_if(found.sockets, [](const rtps::UdpSocket& each) { return each.is_ipv6; });
  return found;
}

// The users that it runs as: the real and the effective one.
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

// The sockets that it opened itself: a file of another user's socket may have been given to it.
class Holdings {
 public:
  explicit Holdings(const fs::path& process)
      : links_(rtps::descriptors_of(process).value_or(std::set<std::string>())),
        users_(links_.empty() ? std::vector<unsigned>() : users_of(process)) {}

  bool has(const Candidates& each) const {
    const auto is_its = [&](const rtps::UdpSocket& socket) {
      return links_.contains(socket.link) && std::ranges::find(users_, socket.user) != users_.end();
    };
    return each.is_exclusive ? !each.sockets.empty() && std::ranges::all_of(each.sockets, is_its)
                             : std::ranges::any_of(each.sockets, is_its);
  }
  bool has_all(const std::vector<Candidates>& all) const {
    return std::ranges::all_of(all, [&](const Candidates& each) { return has(each); });
  }

 private:
  std::set<std::string> links_;
  std::vector<unsigned> users_;
};

int to_pid(const fs::path& process) {
  const std::string name = process.filename().native();
  int pid = 0;
  const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), pid);
  return error == std::errc() && rest == name.data() + name.size() ? pid : 0;
}

// The latest if it is unknown.
std::uint64_t began(const fs::path& process) {
  return rtps::running_since(process).value_or(UINT64_MAX);
}

}  // namespace

ProcessFinder::ProcessFinder(fs::path proc) : proc_(std::move(proc)) {}

FoundProcess ProcessFinder::find(const ParticipantInfo& participant) const {
  std::vector<rtps::UdpAddress> addresses;
  bool may_be_elsewhere = false;
  for (const rtps::UdpAddress& each : participant.metatraffic) {
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

// A participant keeps its listening sockets until it exits, and one that it sends from. A new
// process may get the first ones.
bool ProcessFinder::has_ended(const ParticipantInfo& participant) const {
  const std::vector<rtps::UdpAddress>& from = participant.origin.addresses;
  const auto is_here = [](const rtps::UdpAddress& each) { return is_local(each.ip); };
  if (!std::all_of(from.begin(), from.end(), is_here)) return false;
  const auto is_missed = [&] {
    const std::vector<rtps::UdpSocket> sockets = rtps::udp_sockets(proc_);
    if (sockets.empty()) return false;  // at least the socket that sent the announcement exists
    const auto is_nobodys = [&](const rtps::UdpAddress& each) {
      return bound_to(each, sockets).sockets.empty();
    };
    return std::any_of(participant.metatraffic.begin(), participant.metatraffic.end(),
                       is_nobodys) ||
           (participant.origin.is_complete && !from.empty() &&
            std::all_of(from.begin(), from.end(), is_nobodys));
  };
  // The kernel may pass over a socket of a table that changes while it is read (udp_sockets.h).
  return is_missed() && is_missed();
}

FoundProcess ProcessFinder::prove(const ParticipantInfo& participant,
                                  std::vector<rtps::UdpAddress> addresses,
                                  bool may_be_elsewhere) const {
  if (!participant.origin.is_complete)
    return {0, participant.origin.addresses.empty()
                   ? "nothing is known of where its datagrams come from"
                   : "its datagrams come from more places than one process has"};
  for (const rtps::UdpAddress& each : participant.origin.addresses) {
    // Every machine with containers has the address of a bridge, and it is the same one.
    if (!is_local(each.ip) && may_be_elsewhere) return {};
    if (!is_local(each.ip))
      return {0, "it claims to be on this machine, but datagrams in its name come from " +
                     to_text(each)};
    addresses.push_back(each);
  }

  const std::vector<rtps::UdpSocket> sockets = rtps::udp_sockets(proc_);
  std::vector<Candidates> needed;
  for (const rtps::UdpAddress& each : addresses) {
    const bool is_heard =
        std::ranges::find(participant.origin.addresses, each) != participant.origin.addresses.end();
    needed.push_back(is_heard ? sends_from(each, sockets) : bound_to(each, sockets));
    if (needed.back().sockets.empty())
      return {0, "no process of this machine has the socket " + to_text(each) +
                     " that it announces or sends from"};
  }
  const int pid = oldest(
      participant.pid, [&](const fs::path& process) { return Holdings(process).has_all(needed); });
  if (pid != 0) return {pid, ""};
  const auto is_trusted = [user = geteuid()](const rtps::UdpSocket& socket) {
    return socket.user == 0 || socket.user == user;
  };
  const bool are_trusted = std::ranges::all_of(needed, [&](const Candidates& each) {
    return each.is_exclusive ? std::ranges::all_of(each.sockets, is_trusted)
                             : std::ranges::any_of(each.sockets, is_trusted);
  });
  std::string all;
  for (const rtps::UdpAddress& each : addresses) all += (all.empty() ? "" : ", ") + to_text(each);
  return {0,
          "no process with readable files holds all of its sockets (" + all +
              ") alone; culprit may read another user's only with CAP_SYS_PTRACE",
          false, are_trusted};
}

int ProcessFinder::speaker(const ParticipantInfo& participant) const {
  const std::vector<rtps::UdpSocket> sockets = rtps::udp_sockets(proc_);
  std::vector<Candidates> announced;
  for (const rtps::UdpAddress& each : participant.metatraffic) {
    if (is_local(each.ip)) announced.push_back(bound_to(each, sockets));
  }
  std::vector<Candidates> heard;
  for (const rtps::UdpAddress& each : participant.origin.addresses) {
    if (is_local(each.ip)) heard.push_back(sends_from(each, sockets));
  }
  if (announced.empty() || heard.empty()) return 0;
  return oldest(participant.pid, [&](const fs::path& process) {
    const Holdings its(process);
    return its.has_all(announced) &&
           std::ranges::any_of(heard, [&](const Candidates& each) { return its.has(each); });
  });
}

// Forks of a process hold the same sockets: the claimed PID helps to choose among those.
int ProcessFinder::oldest(int said, const std::function<bool(const fs::path&)>& is_it) const {
  if (said > 0 && is_it(proc_ / std::to_string(said))) return said;
  int oldest = 0;
  std::error_code error;
  for (fs::directory_iterator i(proc_, error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const int pid = to_pid(i->path());
    if (pid <= 0 || !is_it(i->path())) continue;
    if (oldest == 0 || began(i->path()) < began(proc_ / std::to_string(oldest))) oldest = pid;
  }
  return oldest;
}

bool ProcessFinder::is_running(int pid) const {
  return rtps::running_since(proc_ / std::to_string(pid)).has_value();
}

}  // namespace culprit::ros2
