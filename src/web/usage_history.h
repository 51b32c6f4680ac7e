// The usage of each component's process: each look of the last quarter of an hour, and the greatest of each minute of the last day. A thread of its own
// looks every few seconds, with or without a viewer: so the page also shows the time before it was opened.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "base/process_stat.h"
#include "live/observer.h"

namespace culprit::web {

class UsageHistory : public live::Observer {
 public:
  static constexpr std::chrono::seconds kPeriod{5};
  static constexpr std::size_t kMost = 180;      // looks that are kept of a component
  static constexpr std::size_t kMinutes = 1440;  // before them

  struct Usage {
    double clock = 0;          // seconds since 1970
    double processor = 0;      // of one core, since the look before
    std::uint64_t memory = 0;  // bytes
  };
  using Stat = std::function<std::optional<ProcessStat>(int pid)>;

  explicit UsageHistory(Stat stat = stat_of_pid) : stat_(std::move(stat)) {}
  ~UsageHistory() override;

  // Looks every kPeriod from now on, until this ends.
  // Without a thread for it (pids.max) there are no curves.
  void start();
  // One look, at `clock` (seconds since 1970). Processes of other computers are not seen.
  void look(double clock);
  // The last quarter of an hour, oldest first. From any thread.
  std::vector<Usage> of(const std::string& component) const;
  // The last day, likewise.
  std::vector<Usage> day_of(const std::string& component) const;

  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return kNever; }
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  void look_again_and_again();
  struct Process {
    int pid = 0;                   // 0: not known
    double processor_seconds = 0;  // at the last look
    double clock = 0;              // of the last look; 0: none yet
    std::deque<Usage> usage;
    std::deque<Usage> minutes;  // before `usage`
  };
  static std::optional<ProcessStat> stat_of_pid(int pid);
  static void age(Process& process);
  static void add(Process& process, const std::optional<ProcessStat>& stat, double clock);
  void take_pids();

  const Stat stat_;
  const Manager* manager_ = nullptr;  // null: none has begun
  mutable Mutex mutex_;
  ConditionVariable ends_;
  bool is_over_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::map<std::string, Process> processes_ CULPRIT_GUARDED_BY(mutex_);  // by component
  std::thread thread_;
};

}  // namespace culprit::web
