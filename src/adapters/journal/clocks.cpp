#include "journal/clocks.h"

#include <algorithm>
#include <chrono>
#include <sys/timex.h>

#include "journal/session.h"

namespace culprit::journal {

Clocks clocks_now(Time robot) {
  timex state{};  // asks and sets nothing
  const bool is_set = adjtimex(&state) != -1 && (state.status & STA_UNSYNC) == 0;
  const auto wall = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::system_clock::now().time_since_epoch());
  return {boot_id(), robot, wall.count(), is_set};
}

Duration certain_age(const Clocks& then, const Clocks& now) {
  const bool is_same_boot = !now.boot.empty() && then.boot == now.boot;
  if (is_same_boot) return std::max(Duration::zero(), now.robot - then.robot);
  if (!then.is_wall_set || !now.is_wall_set) return Duration::zero();
  return std::max(Duration::zero(), Duration(now.wall - then.wall));
}

}  // namespace culprit::journal
