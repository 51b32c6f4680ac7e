#include "managers/random_manager.h"

#include <array>

namespace culprit::study {
namespace {

namespace modes = suave::model::modes;

constexpr std::array kSearch = {modes::kDefault, "fd_spiral_high", "fd_spiral_low",
                                "fd_spiral_medium", modes::kOff};
constexpr std::array kFollow = {modes::kDefault, modes::kFollow, modes::kOff};

}  // namespace

// The version of the published figures reads a parameter that is never set, and takes its default.
RandomManager::RandomManager(const Setting& setting)
    : SuaveManager(setting),
      period_(std::chrono::seconds(setting.generation.name == "new" ? 30 : 15)) {
  run(follow_tasks());
  run(adapt_periodically());
}

Routine RandomManager::follow_tasks() {
  std::string present;
  for (;;) {
    while (task() == present) co_await news();
    present = task();
    if (present == "inspect") co_await change_mode("search", modes::kOff);
    co_await adapt();
  }
}

Routine RandomManager::adapt_periodically() {
  while (task().empty()) co_await news();
  for (;;) {
    co_await sleep(period_);
    co_await adapt();
  }
}

Routine RandomManager::adapt() {
  if (task() == "search") {
    const std::string mode = kSearch.at(static_cast<std::size_t>(random().below(kSearch.size())));
    co_await change_mode("search", mode);
  } else {
    const std::string mode = kFollow.at(static_cast<std::size_t>(random().below(kFollow.size())));
    co_await change_mode("follow", mode);
  }
}

}  // namespace culprit::study
