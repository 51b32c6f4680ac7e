// `culprit-lab study rover --live`: each fault of the rover, under one manager.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "demo/rover_demo.h"

namespace culprit::lab {

struct RoverStudy {
  RoverDemo::Options demo{};
  std::vector<RoverDemo::Play> plays{};
  Duration patience = RoverDemo::kPatience;
  // Called after each play.
  std::function<void(const RoverDemo::Play&, const PlayOutcome&)> on_outcome{};
};

// Plays them one after the other. A rover that is well afterwards plays on; else a new one is started. An error: a rover does
// not come up, a fault cannot be injected, or `stop` was set.
Expected<void> play_all(const RoverStudy& study, const std::atomic<bool>& stop);

// Whether an incident held one of the components responsible that are.
bool is_blamed(const RoverDemo::Play& play, const PlayOutcome& outcome);

// One row of the table: fault, noticed, blamed, healed, time stood, redeployments of others, goals reached.
std::string header_of_rover_table();
std::string row_of(const RoverDemo::Play& play, const PlayOutcome& outcome);

}  // namespace culprit::lab
