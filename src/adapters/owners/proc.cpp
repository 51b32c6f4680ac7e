#include "owners/proc.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "base/process_stat.h"
#include "base/tracer.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {
namespace {

namespace fs = std::filesystem;

// The numbers that a process has, from the PID namespace of this /proc to the innermost that it is in (NSpid). `process` is a
// number, or "self". Empty if there is no such process.
std::vector<int> numbers_of(const std::string& process) {
  std::vector<int> numbers;
  std::ifstream file("/proc/" + process + "/status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("NSpid:")) continue;
    std::istringstream rest(line.substr(6));
    for (int each = 0; rest >> each;) numbers.push_back(each);
  }
  return numbers;
}

// Its state is 'X' if there is no such process.
ProcessStat family_of(int pid) {
  return process_stat(std::to_string(pid)).value_or(ProcessStat{.state = 'X'});
}

bool is_job_of(const ProcessStat& job, const ProcessStat& shell) {
  return job.terminal != 0 && job.session == shell.session && job.group != shell.group;
}

std::vector<std::string> arguments_of(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string text; std::getline(file, text, '\0');) arguments.push_back(std::move(text));
  return arguments;
}

bool is_interpreter(const fs::path& program) {
  constexpr std::array kNames = {"python", "perl", "ruby", "node", "bash", "dash", "sh"};
  const std::string name = program.filename().native();
  for (const char* each : kNames) {
    const std::size_t length = std::strlen(each);
    // "python3.11" is Python, "shutdown" is no shell.
    if (name.starts_with(each) && name.find_first_not_of("0123456789.", length) == name.npos)
      return true;
  }
  return false;
}

// The first argument that is no option: of `-m` and `-c` what they name.
std::string script_of(int pid) {
  const std::vector<std::string> arguments = arguments_of(pid);
  std::error_code error;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if ((word == "-m" || word == "-c") && i + 1 < arguments.size())
      return word + " " + arguments[i + 1];
    if (word.starts_with('-')) continue;
    const fs::path folder = fs::read_symlink("/proc/" + std::to_string(pid) + "/cwd", error);
    return (folder / word).lexically_normal().native();
  }
  return "";
}

constexpr int kInit = 1;

std::string command_name(int pid) {
  std::string name;
  std::getline(std::ifstream("/proc/" + std::to_string(pid) + "/comm") >> std::ws, name);
  return name;
}

// systemd.unit(5). Other users make control groups, too, with names that have blanks.
bool is_name_of_unit(std::string_view name) {
  return std::ranges::all_of(name, [](unsigned char c) {
    return c < 0x80 &&
           (std::isalnum(c) != 0 ||
            std::string_view(":-_.\\@").find(static_cast<char>(c)) != std::string_view::npos);
  });
}

// The service of systemd whose control group it is in; empty: in none.
std::string service_around(int pid) {
  std::ifstream groups("/proc/" + std::to_string(pid) + "/cgroup");
  for (std::string line; std::getline(groups, line);) {
    // cgroups(7): of version 2, or of the hierarchy that systemd has beside version 1.
    if (!line.starts_with("0::") && line.find(":name=systemd:") == std::string::npos) continue;
    std::string unit = line.substr(line.rfind('/') + 1);
    if (unit.ends_with(".service") && is_name_of_unit(unit)) return unit;
  }
  return "";
}

// A child is born in its parent's session, and leaves it only to make one of its own.
bool has_lost_its_parent(int pid) {
  const ProcessStat it = family_of(pid);
  const ProcessStat heir = family_of(it.parent);
  const bool is_heir =
      it.parent == kInit || (command_name(it.parent) == "systemd" && heir.session == it.parent);
  return is_heir && it.session != 0 && it.session != pid && it.session != heir.session &&
         service_around(pid).empty();
}

bool is_ros2_run(int pid) {
  const std::vector<std::string> arguments = arguments_of(pid);
  return arguments.size() > 2 && is_interpreter(arguments[0]) &&
         fs::path(arguments[1]).filename() == "ros2" && arguments[2] == "run";
}

struct Users {
  unsigned real = 0;
  unsigned effective = 0;
};
std::optional<Users> users_of(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with("Uid:")) continue;
    std::istringstream numbers(line.substr(4));
    Users users;
    if (numbers >> users.real >> users.effective) return users;
    break;
  }
  return std::nullopt;
}

// Both: a program that any user may run as its owner (setuid) keeps the caller as its real user.
bool is_of_own_user(int pid) {
  const auto users = users_of(pid);
  return users && users->real == geteuid() && users->effective == geteuid();
}

Duration now_on(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

}  // namespace

// Five times a second for each process that is watched. The file of the first thread says the same,
// and the kernel does not add up all threads for it.
std::optional<char> state_letter(int pid) {
  const std::string process = std::to_string(pid);
  const FileDescriptor file(
      open(("/proc/" + process + "/task/" + process + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 512> text{};  // a command has 64 bytes at most
  const ssize_t size = read(file.get(), text.data(), text.size());
  if (size <= 0) return std::nullopt;
  const std::string_view line(text.data(), static_cast<std::size_t>(size));
  const auto end = line.rfind(')');
  return end == line.npos || end + 2 >= line.size() ? std::nullopt : std::optional(line[end + 2]);
}

std::optional<std::string> hold_of_debugger(int pid) {
  if (state_letter(pid) != 't' || !is_traced(pid)) return std::nullopt;
  return "process " + std::to_string(pid) +
         " is not replaced while a debugger holds it: let it go on, or end it there";
}

std::optional<std::string> core_dump_of(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with("CoreDumping:")) continue;
    if (!line.ends_with('1')) break;
    return "the core dump of its crashed process " + std::to_string(pid) + " is not complete";
  }
  return std::nullopt;
}

std::optional<int> status_of_zombie(int pid) {
  // For other users' processes it is 0 (proc(5)).
  struct stat owner {};
  const std::string folder = "/proc/" + std::to_string(pid);
  const bool may_be_told =
      geteuid() == 0 || (stat(folder.c_str(), &owner) == 0 && owner.st_uid == geteuid());
  const auto process = process_stat(std::to_string(pid));
  if (!may_be_told || !process || process->state != 'Z') return std::nullopt;
  return process->exit_status;
}

std::optional<int> parent_of(int pid) {
  const auto process = process_stat(std::to_string(pid));
  return process ? std::optional(process->parent) : std::nullopt;
}

Origin origin_of(int pid) {
  for (int looked = 0; looked < 3; ++looked) {
    if (has_lost_its_parent(pid)) return {Origin::What::kEnded, 0};
    const int parent = parent_of(pid).value_or(0);
    if (parent <= kInit) break;
    if (!is_ros2_run(parent)) return {Origin::What::kKnown, parent};
    pid = parent;
  }
  return {};
}

std::optional<bool> is_foreground_job(int pid, int shell) {
  const ProcessStat job = family_of(pid);
  if (job.state == 'X' || job.state == 'Z' || job.is_exiting) return std::nullopt;
  const bool is_in_foreground = job.group == job.foreground;
  return is_in_foreground && is_job_of(job, family_of(shell));
}

bool is_stopped_job(int pid, int shell) {
  const ProcessStat job = family_of(pid);
  if (!is_job_of(job, family_of(shell))) return false;
  return std::ranges::none_of(all_processes(), [&](int each) {
    const ProcessStat family = family_of(each);
    const bool is_its = family.group == job.group && family.session == job.session;
    return is_its && family.state != 'T' && family.state != 'Z';
  });
}

std::optional<SystemdUnit> unit_started_as(int pid) {
  const int parent = parent_of(pid).value_or(0);
  if (command_name(parent) != "systemd") return std::nullopt;
  std::string unit = service_around(pid);
  if (unit.empty()) return std::nullopt;
  return SystemdUnit{std::move(unit), parent != kInit};
}

std::string container_of(int pid) {
  constexpr std::size_t kId = 64;
  std::ifstream groups("/proc/" + std::to_string(pid) + "/cgroup");
  std::string id;
  for (std::string line; std::getline(groups, line);) {
    // "/docker/<id>", "docker-<id>.scope", "libpod-<id>.scope/container": the innermost counts.
    for (std::size_t begin = 0; begin < line.size();) {
      const std::size_t end = line.find_first_not_of("0123456789abcdef", begin);
      const std::size_t length = std::min(end, line.size()) - begin;
      if (length == kId) id = line.substr(begin, kId);
      begin += length + 1;
    }
  }
  return id;
}

std::vector<int> all_processes() {
  std::vector<int> pids;
  std::error_code error;
  for (fs::directory_iterator i("/proc", error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const std::string name = i->path().filename().native();
    int pid = 0;
    const auto [rest, failed] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (failed == std::errc() && rest == name.data() + name.size()) pids.push_back(pid);
  }
  return pids;
}

std::optional<std::int64_t> start_ticks_of(int pid) {
  const auto process = process_stat(std::to_string(pid));
  return process ? std::optional(process->start_ticks) : std::nullopt;
}

std::optional<Time> started_at(int pid) {
  const auto ticks = start_ticks_of(pid);
  if (!ticks) return std::nullopt;
  const std::int64_t in_second = sysconf(_SC_CLK_TCK);
  // It counts from the start of the machine, sleep included; our clock leaves sleep out.
  const Duration sleep = now_on(CLOCK_BOOTTIME) - now_on(CLOCK_MONOTONIC);
  return Time(std::chrono::nanoseconds(*ticks * (1'000'000'000 / in_second)) - sleep);
}

bool was_there(int pid, Time known) {
  const auto started = started_at(pid);
  return started && *started <= known;
}

std::string value_of_variable(int pid, const std::string& prefix) {
  if (!is_of_own_user(pid)) return "";
  std::ifstream environment("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  for (std::string text; std::getline(environment, text, '\0');) {
    if (text.starts_with(prefix)) return text.substr(prefix.size());
  }
  return "";
}

bool has_variable(int pid, const std::string& variable) {
  if (!is_of_own_user(pid)) return false;
  std::ifstream environment("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  for (std::string text; std::getline(environment, text, '\0');) {
    if (text == variable) return true;
  }
  return false;
}

std::vector<int> processes_with(const std::string& variable) {
  std::vector<int> pids = all_processes();
  std::erase_if(pids, [&](int pid) { return !has_variable(pid, variable); });
  return pids;
}

std::string pid_namespace_of(int pid) {
  std::error_code error;
  return fs::read_symlink("/proc/" + std::to_string(pid) + "/ns/pid", error).native();
}

std::string network_namespace_of(int pid) {
  std::error_code error;
  return fs::read_symlink("/proc/" + std::to_string(pid) + "/ns/net", error).native();
}

int own_number_of(int pid) {
  const std::vector<int> numbers = numbers_of(std::to_string(pid));
  return numbers.empty() ? 0 : numbers.back();
}

Expected<void> proc_is_of_our_processes() {
  std::error_code error;
  const bool is_our_number =
      fs::read_symlink("/proc/self", error).native() == std::to_string(getpid());
  // A kernel without PID namespaces shows none.
  if (is_our_number && numbers_of("self").size() <= 1) return {};
  return Error{
      "/proc does not show culprit's own process: it is of another PID namespace, or is not "
      "mounted. By its PIDs culprit would end the wrong processes. Mount culprit's own "
      "(mount -t proc proc /proc); in a container use not the host's /proc, but its PID namespace "
      "(--pid host)"};
}

std::optional<Identity> identity_of(int pid) {
  const std::string process = "/proc/" + std::to_string(pid);
  std::error_code error;
  std::string program = fs::read_symlink(process + "/exe", error).native();
  if (error) return std::nullopt;
  constexpr std::string_view kDeleted = " (deleted)";  // it was reinstalled since
  if (program.ends_with(kDeleted)) program.resize(program.size() - kDeleted.size());
  const auto users = users_of(pid);
  if (!users) return std::nullopt;
  const std::string script = is_interpreter(program) ? script_of(pid) : "";
  return Identity{users->effective, program, script};
}

bool runs_python(const Identity& identity) {
  return fs::path(identity.program).filename().native().starts_with("python");
}

std::string to_string(const Identity& identity) {
  return identity.program + (identity.script.empty() ? "" : " " + identity.script) + " of user " +
         std::to_string(identity.user);
}

std::vector<Relative> descendants_of(int pid) {
  std::vector<std::pair<int, ProcessStat>> all;
  for (const int each : all_processes()) {
    const ProcessStat family = family_of(each);
    if (family.state != 'Z' && family.state != 'X') all.emplace_back(each, family);
  }
  std::vector<Relative> found;
  std::vector<int> open = {pid};
  // PIDs are reused while they are read: no more are found than there are.
  while (!open.empty() && found.size() <= all.size()) {
    const int parent = open.back();
    open.pop_back();
    for (const auto& [child, family] : all) {
      if (family.parent != parent) continue;
      std::ifstream file("/proc/" + std::to_string(child) + "/comm");
      std::string command;
      std::getline(file, command);
      found.push_back({child, std::move(command), family.start_ticks});
      open.push_back(child);
    }
  }
  return found;
}

std::vector<int> children_of(int pid) {
  const std::string process = std::to_string(pid);
  std::ifstream listed("/proc/" + process + "/task/" + process + "/children");
  std::vector<int> pids{std::istream_iterator<int>(listed), {}};
  // The kernel lists them by the thread that started them, if it was built to list them.
  if (pids.empty()) pids = all_processes();
  std::erase_if(pids, [&](int each) {
    const ProcessStat family = family_of(each);
    return family.parent != pid || family.state == 'Z' || family.state == 'X';
  });
  return pids;
}

std::vector<int> members_of_group(int leader) {
  std::vector<int> pids = all_processes();
  std::erase_if(pids, [&](int pid) {
    const ProcessStat family = family_of(pid);
    return family.group != leader || family.session != leader || family.state == 'Z';
  });
  return pids;
}

bool Work::is_more_than(const Work& before) const {
  constexpr std::int64_t kMebibyte = 1 << 20;
  return processor - before.processor >= std::chrono::milliseconds(50) ||
         bytes - before.bytes >= kMebibyte;
}

Work work_of_group(int leader) {
  Work work;
  for (const int pid : members_of_group(leader)) {
    const ProcessStat process = family_of(pid);
    work.processor += process.processor;
    work.bytes += static_cast<std::int64_t>(process.resident_bytes);
  }
  return work;
}

}  // namespace culprit::owners
