#include "doctor/process_watch.h"

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <optional>
#include <poll.h>
#include <sstream>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

#include "base/live_clock.h"
#include "base/process_stat.h"
#include "doctor/start_parameters.h"
#include "owners/proc.h"
#include "owners/start_of.h"

namespace culprit::doctor {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(int pid) { return "/proc/" + std::to_string(pid); }

// The statistics of a process, or of one of its threads. Nothing: it has ended, whether its parent has taken note of that
// or not.
std::optional<ProcessStat> use_of(const std::string& process) {
  const auto stat = process_stat(process);
  return stat && stat->state != 'Z' && stat->state != 'X' ? stat : std::nullopt;
}

std::string command_of(int pid) {
  std::ifstream file(folder_of(pid) / "comm");
  std::string name;
  std::getline(file, name);
  return name;
}

// The processes that adopt orphans.
bool adopts(int pid) {
  constexpr std::array kNames = {"systemd",   "init",        "tini",
                                 "dumb-init", "docker-init", "catatonit"};
  return pid <= 1 || std::ranges::find(kNames, command_of(pid)) != kNames.end();
}

std::uint64_t shared_memory_of(int pid) {
  struct stat status {};
  const fs::path folder = folder_of(pid) / "root/dev/shm";
  return stat(folder.c_str(), &status) == 0 ? status.st_dev : 0;
}

// "/dev/shm/fastrtps_port7415" -> "fastrtps_port7415"; empty: it is no port of Fast DDS.
std::string port_in(const std::string& path) {
  const std::string name = path.substr(path.rfind('/') + 1);
  const bool is_port = path.starts_with("/dev/shm/") &&
                       (name.starts_with("fastrtps_port") || name.starts_with("fastdds_port"));
  return is_port ? name : "";
}

void look_at_ports(int pid, Process& process) {
  constexpr std::string_view kLock = "_el";
  constexpr std::string_view kDeleted = " (deleted)";
  std::error_code error;
  for (fs::directory_iterator file(folder_of(pid) / "fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code is_gone;
    const std::string port = port_in(fs::read_symlink(file->path(), is_gone));
    if (port.ends_with(kLock))
      process.ports_read.insert(port.substr(0, port.size() - kLock.size()));
  }
  std::set<std::string> open;
  std::ifstream maps(folder_of(pid) / "maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t path = line.find('/');
    if (path == std::string::npos) continue;
    const std::string port = port_in(line.substr(path));
    if (port.ends_with(kDeleted)) {
      process.ports_lost.insert(port.substr(0, port.size() - kDeleted.size()));
    } else if (!port.empty()) {
      open.insert(port);
    }
  }
  std::erase_if(process.ports_lost, [&](const std::string& port) { return open.contains(port); });
}

Process started(int pid, const std::vector<std::string>& nodes) {
  Process process;
  process.program = command_of(pid);
  if (const auto at = owners::started_at(pid)) {
    const Duration age = live_now() - *at;
    process.age_at_first = age;
    process.started =
        std::chrono::time_point_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now()) -
        age;
  }
  const int parent = owners::parent_of(pid).value_or(0);
  if (!adopts(parent))
    process.launcher = "process " + std::to_string(parent) + " (" + command_of(parent) + ")";
  process.is_left_over = adopts(parent) && has_unread_output(pid);
  if (const auto identity = owners::identity_of(pid)) process.user = identity->user;
  process.shared_memory = shared_memory_of(pid);
  look_at_ports(pid, process);
  if (const auto start = owners::start_of(pid))
    process.parameters = start_parameters(start->command, start->folder, nodes);
  return process;
}

}  // namespace

bool has_unread_output(int pid) {
  const fs::path output = folder_of(pid) / "fd/1";
  std::error_code error;
  if (!fs::read_symlink(output, error).native().starts_with("pipe:")) return false;
  const int pipe = open(output.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  if (pipe < 0) return false;
  // An error state of the write end means that the other end is closed (poll(2)).
  pollfd state{pipe, POLLOUT, 0};
  const bool is_broken = poll(&state, 1, 0) == 1 && (state.revents & POLLERR) != 0;
  close(pipe);
  return is_broken;
}

std::int64_t free_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("MemAvailable:")) continue;
    std::int64_t kilobytes = 0;
    std::istringstream(line.substr(line.find(':') + 1)) >> kilobytes;
    return kilobytes * 1024;
  }
  return 0;
}

std::set<int> ProcessWatch::sample(const std::map<std::string, int>& nodes, Offset at) {
  std::set<int> ended;
  std::map<int, std::vector<std::string>> by_process;
  for (const auto& [node, pid] : nodes) {
    if (pid != 0) by_process[pid].push_back(node);
  }
  for (const auto& [pid, names] : by_process) {
    const auto use = use_of(std::to_string(pid));
    if (!use) {
      ended.insert(pid);
      continue;
    }
    const auto known = processes_.find(pid);
    Process& process =
        known != processes_.end() ? known->second : processes_[pid] = started(pid, names);
    process.samples.push_back({at, use->processor, static_cast<std::int64_t>(use->resident_bytes)});
    look_at_threads(pid, process, at);
  }
  std::erase_if(processes_, [&](const auto& entry) { return !by_process.contains(entry.first); });
  return ended;
}

// Only of processes that used nearly a whole core since they were looked at last.
void ProcessWatch::look_at_threads(int pid, Process& process, Offset at) {
  constexpr double kBusy = 0.9;
  const auto& samples = process.samples;
  if (samples.size() < 2) return;
  const auto& before = samples[samples.size() - 2];
  const double share = seconds(samples.back().processor - before.processor) /
                       std::max(1e-3, seconds(at - before.at));
  if (share < kBusy) {
    process.busiest_thread = 0;
    threads_.erase(pid);
    return;
  }
  std::map<int, Duration> used;
  std::error_code error;
  for (fs::directory_iterator i(folder_of(pid) / "task", error);
       !error && i != fs::directory_iterator(); i.increment(error)) {
    const std::string thread = i->path().filename();
    if (const auto use = use_of(std::to_string(pid) + "/task/" + thread))
      used[std::atoi(thread.c_str())] = use->processor;
  }
  if (const auto last = threads_.find(pid); last != threads_.end()) {
    double most = 0;
    for (const auto& [thread, time] : used) {
      const auto old = last->second.used.find(thread);
      if (old != last->second.used.end())
        most = std::max(
            most, seconds(time - old->second) / std::max(1e-3, seconds(at - last->second.at)));
    }
    process.busiest_thread = std::min(process.busiest_thread.value_or(most), most);
  }
  threads_[pid] = {std::move(used), at};
}

void ProcessWatch::begin_anew() {
  for (auto& [pid, process] : processes_) {
    process.samples.clear();
    process.busiest_thread.reset();
    if (const auto at = owners::started_at(pid)) process.age_at_first = live_now() - *at;
  }
  threads_.clear();
}

}  // namespace culprit::doctor
