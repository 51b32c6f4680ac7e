#include "managers/metacontrol_manager.h"

#include "exemplars/suave/model/visibility.h"

namespace culprit::study {
namespace {

namespace modes = suave::model::modes;

constexpr double kPeriodSec = 1.5;
// Duration of the inference by Pellet, in a process of its own.
constexpr double kInferenceSec = 0.6;
constexpr double kInferenceSpreadSec = 0.25;

}  // namespace

MetacontrolManager::MetacontrolManager(const Setting& setting) : SuaveManager(setting) {
  run(follow_tasks());
  run(reason());
}

// A task is two objectives, not grounded yet; with its end they are no longer any.
Routine MetacontrolManager::follow_tasks() {
  std::string present;
  for (;;) {
    while (task() == present) co_await news();
    present = task();
    const std::map<std::string, std::string> over = std::exchange(objectives_, {});
    for (const auto& objective : over) co_await change_mode(objective.first, modes::kOff);
    objectives_["motion"] = "";
    objectives_[present == "search" ? "search" : "follow"] = "";
  }
}

Routine MetacontrolManager::reason() {
  co_await sleep(from_seconds(kPeriodSec * random().uniform()));
  for (;;) {
    const Time next = later(now(), from_seconds(kPeriodSec));
    if (!objectives_.empty()) co_await reason_once();
    co_await sleep_until(next);
  }
}

Routine MetacontrolManager::reason_once() {
  const std::map<std::string, std::string> known = objectives_;
  const bool was_thruster_failed = is_thruster_failed();
  co_await sleep(from_seconds(kInferenceSec + kInferenceSpreadSec * random().uniform()));
  for (const auto& objective : known) {
    const std::string function = objective.first;
    const std::string design = best_design(function, was_thruster_failed);
    if (design.empty() || !objectives_.contains(function) || objectives_[function] == design)
      continue;
    bool is_done = false;
    co_await change_mode(function, design, &is_done);
    if (is_done && objectives_.contains(function)) objectives_[function] = design;
  }
}

std::string MetacontrolManager::best_design(const std::string& function,
                                            bool is_thruster_failed) const {
  if (function == "motion") return is_thruster_failed ? modes::kRecover : modes::kAllThrusters;
  if (function == "follow") return modes::kFollow;
  const double visibility = number("visibility", 0);
  for (const suave::model::SearchMode& mode : suave::model::kSearchModes) {
    if (latest("visibility") == nullptr || visibility >= mode.visibility) return mode.name;
  }
  return "";
}

}  // namespace culprit::study
