// Plays of the live rover, one after the other.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "rover_study/play.h"

namespace culprit::study {

// "none", "respawn", "paper", "bayes": each beside Nav2's lifecycle managers.
const std::vector<std::string>& live_rover_managers();

// A rover that is well after a play plays on; else a new one is started. An error: a rover does not come up, a fault cannot be
// injected, or `stop` was set. @pre `manager` is one of live_rover_managers()
Expected<std::vector<RoverResult>> play_live(
    const std::vector<rover::Play>& plays, const std::string& manager, Duration patience,
    const std::atomic<bool>& stop,
    const std::function<void(const rover::Play&, const RoverResult&)>& on_result);

}  // namespace culprit::study
