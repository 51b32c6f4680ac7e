#include "cli/paths.h"

#include <cstdlib>
#include <system_error>

namespace culprit::cli {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
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

}  // namespace culprit::cli
