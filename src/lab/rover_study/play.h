// One play of the rover in virtual time: faults at once, under one manager.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "exemplars/rover/faults.h"
#include "knowledge/event.h"
#include "language/rule_set.h"

namespace culprit::study {

// "none", "nav2", "respawn", "watchdog", "paper", "bayes", "oracle": each but the first beside Nav2's lifecycle managers.
const std::vector<std::string>& rover_managers();

// Live or in virtual time.
struct RoverResult {
  // The time from the fault until the rover was well for 2 s; nothing: not within kPatience. As live: it drives, all servers are
  // active, the fault is over, and no failure is open.
  std::optional<double> healed_s{};
  // From the fault until it stands for good; nothing: it drives in the end.
  std::optional<double> stands_after_s{};
  double watched_s = 0;             // from the fault to the end
  double stood_s = 0;               // of that time
  int goals = 0;                    // reached in that time
  std::optional<int> collisions{};  // live only
  int blamed = 0;                   // faults whose component an incident held responsible
  int wrong_restarts = 0;  // healthy components that were ended or deactivated; live: redeployed
  int calls = 0;           // for a person: rules that were exhausted, and rules that only report
  bool is_noticed = false;
  std::vector<std::string> names{};       // of the components that were held responsible
  std::vector<std::string> strategies{};  // executed
  std::string complaint{};                // what is still wrong at the end; empty: nothing
};

// The faults whose component is among `names`.
int right_of(const rover::Play& play, const std::vector<std::string>& names);

struct RoverTimes {
  static constexpr Duration kPatience = std::chrono::seconds(60);  // as live
  static constexpr Duration kWarmUp = std::chrono::seconds(15);    // before the fault
  static constexpr Duration kWatched = std::chrono::seconds(90);   // after the fault
};

// The same play and manager, the same result. @pre `manager` is one of rover_managers()
RoverResult play(const RuleSet& rules, const rover::Play& play, const std::string& manager,
                 Duration watched = RoverTimes::kWatched,
                 const std::function<void(const Event&)>& on_event = {});

}  // namespace culprit::study
