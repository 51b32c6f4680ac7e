// Campaigns that a page started: one at a time, each a process of its own with the lowest priority
// and one thread.
#pragma once

#include <chrono>
#include <filesystem>

#include "base/mutex.h"
#include "web/calls.h"

namespace culprit::web {

// All members may be called from any thread.
class StudyRunner {
 public:
  // Results go there, in place of those of the last campaign.
  explicit StudyRunner(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // Ends a campaign that still runs.
  ~StudyRunner() { stop(); }
  StudyRunner(const StudyRunner&) = delete;

  // Errors: a campaign is running, or cannot be started.
  Expected<void> start(const Studies::Campaign& campaign);
  void stop();
  std::optional<Studies::Progress> progress();
  // Errors: there is none.
  Expected<std::string> result();
  Expected<std::string> report();

  // For the routes; the runner must outlive them.
  Studies studies();

 private:
  using Clock = std::chrono::steady_clock;

  void look() CULPRIT_REQUIRES(mutex_);  // whether the process has ended
  std::filesystem::path file(const char* name) const { return folder_ / name; }
  Expected<std::string> finished(const char* name);

  const std::filesystem::path folder_;
  Mutex mutex_;
  std::optional<Studies::Progress> last_ CULPRIT_GUARDED_BY(mutex_);
  int pid_ CULPRIT_GUARDED_BY(mutex_) = 0;  // 0: none runs
  Clock::time_point begin_ CULPRIT_GUARDED_BY(mutex_);
};

// How many of how many: what the last line of progress in `log` says.
std::optional<std::pair<std::uint64_t, std::uint64_t>> last_progress(const std::string& log);

// The lines behind the last one of progress; all if there is none.
std::string after_progress(const std::string& log);

}  // namespace culprit::web
