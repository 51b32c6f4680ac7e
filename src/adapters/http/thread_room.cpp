#include "http/thread_room.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace culprit::http {
namespace {

namespace fs = std::filesystem;

// Nothing: "max", or no such file.
std::optional<std::size_t> number_in(const fs::path& file) {
  std::ifstream in(file);
  std::size_t number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

std::optional<std::size_t> left_in(const fs::path& group) {
  const auto most = number_in(group / "pids.max");
  const auto now = number_in(group / "pids.current");
  if (!most || !now) return std::nullopt;
  return *most > *now ? *most - *now : 0;
}

}  // namespace

std::optional<std::size_t> threads_left(const std::string& groups, const fs::path& mounted) {
  std::optional<std::size_t> least;
  std::istringstream lines(groups);
  for (std::string line; std::getline(lines, line);) {
    const auto controllers = line.find(':') + 1;
    const auto path = line.find(":/", controllers);
    if (controllers == 0 || path == std::string::npos) continue;
    const std::string kinds = "," + line.substr(controllers, path - controllers) + ",";
    const bool is_second_version = kinds == ",,";
    if (!is_second_version && kinds.find(",pids,") == std::string::npos) continue;
    const fs::path root = is_second_version ? mounted : mounted / "pids";
    // In a container the path may be that outside it.
    fs::path group = root;
    auto left = left_in(group);
    for (const fs::path& part : fs::path(line.substr(path + 2))) {
      if (left) least = std::min(least.value_or(*left), *left);
      group /= part;
      left = left_in(group);
    }
    if (left) least = std::min(least.value_or(*left), *left);
  }
  return least;
}

std::optional<std::size_t> threads_left() {
  std::ostringstream groups;
  groups << std::ifstream("/proc/self/cgroup").rdbuf();
  return threads_left(groups.str(), "/sys/fs/cgroup");
}

}  // namespace culprit::http
