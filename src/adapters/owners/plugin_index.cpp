#include "owners/plugin_index.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "base/closest.h"
#include "base/environment.h"

namespace culprit::owners {
namespace {

constexpr const char* kIndex = "share/ament_index/resource_index/rclcpp_components";
constexpr std::size_t kLongestIndex = 1 << 20;  // bytes

// A line is "package::Class;lib/libclass.so".
std::vector<std::string> classes_in(const std::filesystem::path& file) {
  std::vector<std::string> classes;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) ||
      std::filesystem::file_size(file, error) > kLongestIndex)
    return classes;
  std::ifstream in(file, std::ios::binary);
  for (std::string line; std::getline(in, line);) {
    if (const auto end = line.find(';'); end != std::string::npos && end > 0)
      classes.push_back(line.substr(0, end));
  }
  return classes;
}

std::string perhaps(const std::string& wanted, const std::vector<std::string>& known) {
  const std::string near = closest(wanted, {known.begin(), known.end()});
  return near.empty() ? "" : "; did you mean " + near + "?";
}

}  // namespace

Expected<void> find_plugin(int pid, const std::string& package, const std::string& plugin) {
  const auto prefixes = environment_of(pid, "AMENT_PREFIX_PATH");
  if (!prefixes)
    return Error{"the components that its container could load are unknown: process " +
                 std::to_string(pid) + " shows no AMENT_PREFIX_PATH"};
  // In a mount namespace of its own the same paths lead elsewhere.
  const std::filesystem::path root = "/proc/" + std::to_string(pid) + "/root";
  std::vector<std::string> packages;
  std::istringstream all(*prefixes);
  for (std::string prefix; std::getline(all, prefix, ':');) {
    const std::filesystem::path index =
        root / std::filesystem::path(prefix).relative_path() / kIndex;
    std::error_code error;
    for (std::filesystem::directory_iterator each(index, error), end; !error && each != end;
         each.increment(error))
      packages.push_back(each->path().filename().string());
    if (!std::filesystem::exists(index / package, error)) continue;
    // The first one that has the package is the one that counts.
    const auto classes = classes_in(index / package);
    if (std::find(classes.begin(), classes.end(), plugin) != classes.end()) return {};
    return Error{"the package " + package + " has no component " + plugin +
                 perhaps(plugin, classes)};
  }
  return Error{"its container finds no components of a package " + package +
               perhaps(package, packages)};
}

}  // namespace culprit::owners
