#include "base/process_stat.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace culprit {

std::optional<ProcessStat> process_stat(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  // The second field is the program's name in brackets, in which anything may stand.
  std::istringstream rest(line.substr(std::min(line.rfind(')') + 1, line.size())));
  std::string skipped;
  const auto skip = [&](int count) {
    for (int i = 0; i < count; ++i) rest >> skipped;
  };
  ProcessStat stat;
  std::int64_t user_ticks = 0;
  std::int64_t system_ticks = 0;
  std::uint64_t resident_pages = 0;
  rest >> stat.state >> stat.parent >> stat.group >> stat.session >> stat.terminal >>
      stat.foreground;
  constexpr std::uint64_t kExiting = 4;  // PF_EXITING
  std::uint64_t flags = 0;
  rest >> flags;
  skip(4);  // to field 14
  rest >> user_ticks >> system_ticks;
  skip(4);  // to field 19
  rest >> stat.threads;
  skip(1);
  rest >> stat.start_ticks >> stat.virtual_bytes >> resident_pages;
  if (rest.fail()) return std::nullopt;
  const std::int64_t ticks = sysconf(_SC_CLK_TCK);
  stat.processor = std::chrono::nanoseconds((user_ticks + system_ticks) * (1'000'000'000 / ticks));
  stat.is_exiting = (flags & kExiting) != 0;
  stat.started_after_boot = static_cast<double>(stat.start_ticks) / static_cast<double>(ticks);
  stat.resident_bytes = resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  if (stat.state == 'Z') {
    skip(27);  // fields 25 to 51
    rest >> stat.exit_status;
  }
  return stat;
}

}  // namespace culprit
