#include "demo/rover_study.h"

#include <algorithm>
#include <chrono>

#include <fmt/core.h>

#include "base/live_clock.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

bool is_well_soon(const RoverDemo& demo) {
  for (const Time end = later(live_now(), 15s); live_now() < end;) {
    if (demo.measure().complaint.empty()) return true;
    std::this_thread::sleep_for(100ms);
  }
  return false;
}

bool is_cause(const RoverDemo::Play& play, const std::string& component) {
  return std::ranges::any_of(play.faults,
                             [&](const auto* fault) { return fault->cause == component; });
}

std::string blamed_in(const RoverDemo::Play& play, const PlayOutcome& outcome) {
  for (const std::string& each : outcome.blamed)
    if (is_cause(play, each)) return each;
  return outcome.blamed.empty() ? "none" : "not it: " + outcome.blamed.front();
}

}  // namespace

Expected<void> play_all(const RoverStudy& study, const std::atomic<bool>& stop) {
  std::unique_ptr<RoverDemo> demo;
  for (const RoverDemo::Play& play : study.plays) {
    if (!demo) {
      auto started = RoverDemo::start(study.demo, stop);
      if (!started) return Error{started.error()};
      demo = std::move(*started);
    }
    auto outcome = demo->play(play, study.patience);
    if (!outcome) return Error{outcome.error()};
    if (study.on_outcome) study.on_outcome(play, *outcome);
    if (!outcome->is_resolved() || !is_well_soon(*demo)) demo.reset();
  }
  return {};
}

bool is_blamed(const RoverDemo::Play& play, const PlayOutcome& outcome) {
  return std::ranges::any_of(outcome.blamed,
                             [&](const std::string& each) { return is_cause(play, each); });
}

std::string header_of_rover_table() {
  return fmt::format("{:<34} {:<8} {:<30} {:>8} {:>8} {:>7} {:>6}\n", "fault", "noticed", "blamed",
                     "healed", "stood", "others", "goals");
}

std::string row_of(const RoverDemo::Play& play, const PlayOutcome& outcome) {
  const bool is_fixable = std::ranges::all_of(play.faults, &rover::Fault::is_fixable);
  std::string healed = outcome.is_resolved() ? "stops" : "drives";
  if (is_fixable) healed = outcome.healed_s ? fmt::format("{:.1f} s", *outcome.healed_s) : "no";
  return fmt::format("{:<34} {:<8} {:<30} {:>8} {:>6.1f} s {:>7} {:>6}\n", play.name,
                     outcome.failures.empty() ? "no" : "yes", blamed_in(play, outcome), healed,
                     outcome.downtime, outcome.unnecessary_redeployments, outcome.goals);
}

}  // namespace culprit::lab
