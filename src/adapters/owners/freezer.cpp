#include "owners/freezer.h"

#include <array>
#include <fcntl.h>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

namespace culprit::owners {
namespace {

constexpr std::string_view kCgroups = "/sys/fs/cgroup";

// The files that show it, as far as this machine has them. `group`: a line of cgroups(7), "0::/app.slice/lidar.service".
std::vector<std::string> files_of(const std::string& group) {
  const std::size_t first = group.find(':');
  const std::size_t second = group.find(':', first + 1);
  if (first == std::string::npos || second == std::string::npos) return {};
  const std::string controllers = group.substr(first + 1, second - first - 1);
  const std::string path = group.substr(second + 1);
  const std::string folder(kCgroups);
  if (controllers.empty())
    return {folder + path + "/cgroup.events", folder + "/unified" + path + "/cgroup.events"};
  if (controllers == "freezer") return {folder + "/freezer" + path + "/freezer.state"};
  return {};
}

}  // namespace

Freezer::Freezer(int pid) {
  std::ifstream groups("/proc/" + std::to_string(pid) + "/cgroup");
  for (std::string line; std::getline(groups, line);) {
    for (const std::string& file : files_of(line)) {
      FileDescriptor state(open(file.c_str(), O_RDONLY | O_CLOEXEC));
      if (state) states_.push_back(std::move(state));
    }
  }
}

bool Freezer::is_frozen() const {
  for (const FileDescriptor& each : states_) {
    std::array<char, 256> text{};
    const ssize_t size = pread(each.get(), text.data(), text.size(), 0);
    if (size <= 0) continue;
    const std::string_view said(text.data(), static_cast<std::size_t>(size));
    if (said.starts_with("FROZEN") || said.find("frozen 1") != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace culprit::owners
