// Disks that are full, or will be soon.
#include <fmt/core.h>

#include "base/name_grammar.h"
#include "doctor/examine.h"
#include "doctor/wording.h"

namespace culprit::doctor {

void examine_disks(const Picture& picture, Findings& all) {
  using namespace std::chrono_literals;
  constexpr std::int64_t kFull = 100'000'000;          // bytes
  constexpr std::int64_t kNearlyFull = 2'000'000'000;  // and a twentieth of its size
  constexpr Duration kSoon = 1h;
  for (const Disk& disk : picture.disks) {
    if (disk.size <= 0) continue;
    const double share = static_cast<double>(disk.free) / static_cast<double>(disk.size);
    const bool is_full = disk.free < kFull || share < 0.005;
    const bool is_nearly_full = disk.free < kNearlyFull && share < 0.05;
    const double rate =
        picture.looked > 0s ? static_cast<double>(disk.taken) / seconds(picture.looked) : 0;
    const Duration left =
        rate > 0 ? from_seconds(static_cast<double>(disk.free) / rate) : Duration::max();
    // A write rate over some seconds says little unless little space is left.
    const bool fills = share < 0.1 && left < kSoon;
    if (!is_full && !is_nearly_full && !fills) continue;
    all.push_back({"D060", is_full ? Gravity::kError : Gravity::kWarning,
                   "disk of " + printable(disk.folder),
                   fmt::format("{} of {} are free{}", bytes(disk.free), bytes(disk.size),
                               fills ? ", and at the rate of now none in " + duration(left) : ""),
                   "what cannot be written is lost, and some programs end then: it holds " +
                       printable(disk.used_for),
                   "remove old logs and bags (du -sh ~/.ros/log), or record elsewhere"});
  }
}

}  // namespace culprit::doctor
