#include "doctor/held_up.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

namespace culprit::doctor {

std::optional<Duration> wait_in(const std::string& schedstat) {
  std::istringstream words(schedstat);
  std::int64_t running = 0, waiting = 0;
  if (!(words >> running >> waiting) || waiting < 0) return std::nullopt;
  return std::chrono::nanoseconds(waiting);
}

std::map<int, Duration> waits_of_own_threads() {
  namespace fs = std::filesystem;
  std::map<int, Duration> waits;
  std::error_code error;
  for (fs::directory_iterator i("/proc/self/task", error); !error && i != fs::directory_iterator();
       i.increment(error)) {
    std::ifstream file(i->path() / "schedstat");
    std::string line;
    std::getline(file, line);
    if (const auto wait = wait_in(line)) waits[std::atoi(i->path().filename().c_str())] = *wait;
  }
  return waits;
}

Duration longest_wait(const std::map<int, Duration>& before, const std::map<int, Duration>& now) {
  Duration longest{};
  for (const auto& [thread, wait] : now) {
    const auto began = before.find(thread);
    longest = std::max(longest, began == before.end() ? wait : wait - began->second);
  }
  return longest;
}

bool was_held_up(const Picture& picture) { return picture.waited > picture.looked / 4; }

bool is_of_absence(const std::string& code) {
  constexpr std::array<std::string_view, 19> kCodes = {
      "D003", "D004", "D009", "D011", "D012", "D013", "D021", "D030", "D040", "D041",
      "D046", "D050", "D051", "D054", "D100", "D102", "D104", "D108", "D109"};
  return std::ranges::find(kCodes, code) != kCodes.end();
}

}  // namespace culprit::doctor
