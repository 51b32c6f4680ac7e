#include "base/environment.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <unistd.h>

namespace culprit {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

std::filesystem::path default_state_folder() {
  const std::string state = environment("XDG_STATE_HOME");
  if (!state.empty()) return std::filesystem::path(state) / "culprit";
  const std::string home = environment("HOME");
  return std::filesystem::path(home.empty() ? "/tmp" : home) / ".local" / "state" / "culprit";
}

std::filesystem::path own_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

namespace {

// The first `program` in `list`, folders as PATH has them; empty: it is in none.
std::filesystem::path program_in(const std::string& list, const char* program) {
  std::istringstream folders(list);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path place = std::filesystem::path(folder) / program;
    if (!folder.empty() && access(place.c_str(), X_OK) == 0) return place;
  }
  return {};
}

}  // namespace

std::string culprit_at_terminal() {
  constexpr const char* kProgram = "culprit";
  if (!program_in(environment("PATH"), kProgram).empty()) return kProgram;
  return program_in(own_folder(), kProgram);
}

Expected<std::filesystem::path> find_laboratory() {
  const auto place = program_in(own_folder().native() + ":" + environment("PATH"), "culprit-lab");
  if (!place.empty()) return place;
  return Error{
      "studies, torture and demonstrations are of culprit-lab, which is neither beside culprit nor "
      "in PATH; install it, or build it: cmake --build --preset release --target culprit-lab"};
}

std::optional<std::string> environment_of(int pid, const std::string& name) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
  for (std::string entry; std::getline(in, entry, '\0');) {
    if (entry.starts_with(name + "=")) return entry.substr(name.size() + 1);
  }
  return std::nullopt;
}

}  // namespace culprit
