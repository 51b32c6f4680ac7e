#include "link/processor_time.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "base/live_clock.h"

namespace culprit::link {

std::optional<Duration> processor_time_wanted(int pid) {
  std::error_code error;
  std::optional<Duration> wanted;
  const std::string tasks = "/proc/" + std::to_string(pid) + "/task";
  for (std::filesystem::directory_iterator i(tasks, error), end; !error && i != end;
       i.increment(error)) {
    // Documentation/scheduler/sched-stats: nanoseconds on a processor, and waiting for one.
    std::ifstream file(i->path() / "schedstat");
    std::int64_t had = 0;
    std::int64_t waited = 0;
    if (file >> had >> waited)
      wanted = wanted.value_or(Duration::zero()) + std::chrono::nanoseconds(had + waited);
  }
  return wanted;
}

std::optional<ProcessorLook> look_at_processor_time(int pid) {
  const auto wanted = processor_time_wanted(pid);
  return wanted ? std::optional(ProcessorLook{pid, live_now(), *wanted}) : std::nullopt;
}

bool was_at_work(const ProcessorLook& before, const ProcessorLook& after) {
  constexpr int kShare = 5;
  return before.pid == after.pid && after.at > before.at &&
         after.wanted - before.wanted >= (after.at - before.at) / kShare;
}

}  // namespace culprit::link
