#include "exemplars/sunset/crash_at_start.h"

#include <fstream>
#include <string>
#include <system_error>

namespace culprit::sunset {
namespace {

std::filesystem::path file_of(const std::filesystem::path& state, std::string_view name) {
  return state / (std::string(name) + ".crashes");
}

}  // namespace

Expected<void> arm_crash(const std::filesystem::path& state, std::string_view name, int starts) {
  if (state.empty()) return Error{"a crash at start needs a state folder; give --state"};
  std::error_code error;
  const auto path = file_of(state, name);
  if (starts <= 0) {
    std::filesystem::remove(path, error);
  } else {
    std::filesystem::create_directories(state, error);
    if (!(std::ofstream(path) << starts << std::flush)) {
      return Error{path.string() + " cannot be written"};
    }
  }
  return error ? Error{path.string() + ": " + error.message()} : Expected<void>();
}

bool take_crash(const std::filesystem::path& state, std::string_view name) {
  if (state.empty()) return false;
  int starts = 0;
  std::ifstream(file_of(state, name)) >> starts;
  if (starts <= 0) return false;
  // If it cannot be counted down, it goes on crashing, which is what was asked for.
  (void)arm_crash(state, name, starts - 1);
  return true;
}

}  // namespace culprit::sunset
