#include "process/proc.h"

#include <charconv>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <unistd.h>

namespace culprit::process {
namespace {

namespace fs = std::filesystem;

// What /proc/<pid>/stat says after the command, which is in parentheses and may hold anything.
std::string stat_after_command(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  std::getline(file, line);
  const auto end = line.rfind(')');
  return end == std::string::npos || end + 2 >= line.size() ? "" : line.substr(end + 2);
}

Duration now_on(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

}  // namespace

std::optional<char> state_letter(int pid) {
  const std::string rest = stat_after_command(pid);
  return rest.empty() ? std::nullopt : std::optional(rest.front());
}

std::optional<Time> started_at(int pid) {
  std::istringstream rest(stat_after_command(pid));
  std::string skipped;
  constexpr int kBefore = 19;  // fields between the command and starttime (proc(5))
  for (int i = 0; i < kBefore; ++i) rest >> skipped;
  std::int64_t ticks = 0;
  if (!(rest >> ticks)) return std::nullopt;
  const std::int64_t in_second = sysconf(_SC_CLK_TCK);
  // It counts from the start of the machine, sleep included; our clock leaves sleep out.
  const Duration sleep = now_on(CLOCK_BOOTTIME) - now_on(CLOCK_MONOTONIC);
  return Time(std::chrono::nanoseconds(ticks * (1'000'000'000 / in_second)) - sleep);
}

bool has_variable(int pid, const std::string& variable) {
  std::ifstream environment("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  for (std::string text; std::getline(environment, text, '\0');) {
    if (text == variable) return true;
  }
  return false;
}

std::vector<int> processes_with(const std::string& variable) {
  std::vector<int> pids;
  std::error_code error;
  for (fs::directory_iterator i("/proc", error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const std::string name = i->path().filename().native();
    int pid = 0;
    const auto [rest, failed] = std::from_chars(name.data(), name.data() + name.size(), pid);
    const bool is_process = failed == std::errc() && rest == name.data() + name.size();
    if (is_process && has_variable(pid, variable)) pids.push_back(pid);
  }
  return pids;
}

}  // namespace culprit::process
