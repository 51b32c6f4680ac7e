#include "exemplars/node_process.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace culprit {
namespace {

namespace fs = std::filesystem;

// The NUL-terminated texts of a file such as /proc/1/cmdline; none if it cannot be read.
std::vector<std::string> texts_of(const fs::path& file) {
  std::vector<std::string> texts;
  std::ifstream stream(file, std::ios::binary);
  for (std::string text; std::getline(stream, text, '\0');) texts.push_back(text);
  return texts;
}

bool runs(const fs::path& process, std::string_view program, std::string_view name) {
  const auto arguments = texts_of(process / "cmdline");  // empty when it has ended
  return arguments.size() >= 2 && fs::path(arguments.front()).filename() == program &&
         std::ranges::find(arguments, name) != arguments.end();
}

bool is_in(const fs::path& process, std::uint32_t domain) {
  static constexpr std::string_view kName = "ROS_DOMAIN_ID=";
  const auto environment = texts_of(process / "environ");
  const auto found = std::ranges::find_if(
      environment, [](const std::string& variable) { return variable.starts_with(kName); });
  const std::string own = found == environment.end() ? "0" : found->substr(kName.size());
  return !environment.empty() && own == std::to_string(domain);
}

}  // namespace

std::vector<int> processes_of(std::string_view program, std::string_view name,
                              std::uint32_t domain) {
  std::vector<int> pids;
  std::error_code error;
  for (fs::directory_iterator i("/proc", error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    const std::string file = i->path().filename().native();
    int pid = 0;
    const auto [rest, failed] = std::from_chars(file.data(), file.data() + file.size(), pid);
    const bool is_process = failed == std::errc() && rest == file.data() + file.size();
    if (is_process && runs(i->path(), program, name) && is_in(i->path(), domain))
      pids.push_back(pid);
  }
  return pids;
}

}  // namespace culprit
