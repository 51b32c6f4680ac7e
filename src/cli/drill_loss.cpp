#include "cli/drill_loss.h"

#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "base/live_clock.h"
#include "owners/piped_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

constexpr int kLostPercent = 80;
constexpr Duration kNftAnswersWithin = 3s;

// The inodes of its sockets: "socket:[4711]" among its descriptors.
std::set<std::string> sockets_of(int pid) {
  constexpr std::string_view kSocket = "socket:[";
  std::set<std::string> inodes;
  std::error_code gone;
  const std::filesystem::path folder = "/proc/" + std::to_string(pid) + "/fd";
  for (const auto& each : std::filesystem::directory_iterator(folder, gone)) {
    const std::string target = std::filesystem::read_symlink(each.path(), gone).string();
    if (target.starts_with(kSocket))
      inodes.insert(target.substr(kSocket.size(), target.size() - kSocket.size() - 1));
  }
  return inodes;
}

std::string network_of(const std::string& pid) {
  std::error_code gone;
  return std::filesystem::read_symlink("/proc/" + pid + "/ns/net", gone).string();
}

std::string table_of(int pid) { return "culprit_drill_" + std::to_string(pid); }

std::string rules_for(int pid) {
  std::string ports;
  for (const int port : own_ports_of(pid))
    ports += (ports.empty() ? "" : ", ") + std::to_string(port);
  std::string rules;
  for (const char* end : {"dport", "sport"})
    rules +=
        fmt::format(" udp {} {{ {} }} numgen random mod 100 < {} drop;", end, ports, kLostPercent);
  return fmt::format(
      "table inet {} {{ flags owner; chain input {{ type filter hook input priority 0;{} }}; }}\n",
      table_of(pid), rules);
}

// nft, which reads from the other end of the pipe, and is killed after `at_most`.
Expected<int> start_nft(int read_end, Duration at_most) {
  const std::string limit = fmt::format("{:.1f}", seconds(at_most));
  std::vector<std::string> words{"timeout", "-s", "KILL", limit, "nft", "-i"};
  std::vector<char*> arguments;
  for (std::string& each : words) arguments.push_back(each.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, read_end, STDIN_FILENO);
  for (const int out : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, out, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSID);
  int child = 0;
  const int failure = posix_spawnp(&child, "timeout", &files, &how, arguments.data(), environ);
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  if (failure != 0) return Error{std::string("nft cannot be started: ") + std::strerror(failure)};
  return child;
}

bool succeeds(std::vector<std::string> words) {
  const auto run = owners::run_piped(std::move(words), {}, kNftAnswersWithin);
  return run && run->end == owners::PipedRun::End::kItself && run->status == 0;
}

}  // namespace

std::set<int> own_ports_of(int pid) {
  const std::set<std::string> own = sockets_of(pid);
  std::map<int, bool> ports;  // whether others have it, too
  for (const char* table : {"udp", "udp6"}) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/net/" + table);
    std::string line;
    for (std::getline(file, line); std::getline(file, line);) {
      std::istringstream words(line);
      std::string number, local, word, inode;
      words >> number >> local;
      for (int skipped = 0; skipped < 7; ++skipped) words >> word;
      words >> inode;
      const std::size_t colon = local.rfind(':');
      if (colon == std::string::npos) continue;
      const int port = static_cast<int>(std::strtol(local.c_str() + colon + 1, nullptr, 16));
      ports[port] |= !own.contains(inode);
    }
  }
  std::set<int> out;
  for (const auto& [port, is_shared] : ports)
    if (!is_shared && port != 0) out.insert(port);
  return out;
}

Expected<void> may_lose_datagrams(int pid) {
  if (network_of(std::to_string(pid)) != network_of("self"))
    return Error{"process " + std::to_string(pid) + " lives in another network namespace"};
  if (own_ports_of(pid).empty())
    return Error{"process " + std::to_string(pid) + " has no UDP port of its own"};
  if (!succeeds({"nft", "list", "tables"}))
    return Error{"nft is missing, or not permitted to this user (CAP_NET_ADMIN)"};
  return {};
}

Expected<FaultGuard> lose_datagrams(int pid, Duration at_most) {
  if (auto may = may_lose_datagrams(pid); !may) return Error{may.error()};
  auto pipe = owners::make_pipe();
  if (!pipe) return Error{pipe.error()};
  const auto child = start_nft(pipe->read_end.get(), at_most);
  if (!child) return Error{child.error()};
  FaultGuard guard{*child, std::move(pipe->write_end)};
  const std::string rules = rules_for(pid);
  const bool is_sent =
      write(guard.alive.get(), rules.data(), rules.size()) == static_cast<ssize_t>(rules.size());
  for (const Time end = live_now() + kNftAnswersWithin; is_sent && live_now() < end;) {
    if (succeeds({"nft", "list", "table", "inet", table_of(pid)})) return guard;
    std::this_thread::sleep_for(20ms);
  }
  guard.alive = owners::FileDescriptor();
  waitpid(guard.pid, nullptr, 0);
  return Error{"nft does not take the rules"};
}

}  // namespace culprit::cli
