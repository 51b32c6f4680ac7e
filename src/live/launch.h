// `run --launch`: starts what is missing, and brings up what stands still after its start.
//
// A node is one with a lifecycle if it shows the services of one within a second after all else that it shows, or within 10 s
// where the file says LIFECYCLE managed. A lifecycle node that nobody drives stays unconfigured for ever: it is configured and activated,
// in the order of the DEPENDENCY lines, and where they say nothing in that of the file. A node that
// does it itself, or has somebody who does, is left alone: the file says so (LIFECYCLE), or it moved
// within its time. That is twice as long as it took when somebody else brought it up before; none where
// culprit did; and where nothing is known, as long as its start took. Nothing is judged meanwhile: the manager begins afterwards,
// so that a start of many is no storm. What is RESPAWNED is for its launcher to start.
//
// What is not finished is kept on disk meanwhile: a culprit that comes after one that was killed brings
// up what that one had started, also if it is not to launch anything itself.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/expected.h"
#include "knowledge/history.h"
#include "knowledge/known_robot.h"
#include "live/listener.h"
#include "robot/robot.h"

namespace culprit::live {

// Starts a component's LAUNCH command; a Reply to the command says whether it runs.
using StartComponent = std::function<void(CommandId, ComponentId)>;

struct LaunchTimes {
  Duration look = std::chrono::seconds(3);         // at what runs already
  Duration patience = std::chrono::seconds(60);    // from the first start: later none is brought up
  Duration least_grace = std::chrono::seconds(1);  // for a node to move by itself
  Duration transition = std::chrono::seconds(10);  // for each that is asked for
};

// What a launch has not finished: components by name, and whether culprit has begun to take it through
// its lifecycle, so that where it stands is no intention.
using Unfinished = std::map<std::string, bool>;

// Beside the journal. Reading gives nothing where there is nothing to read; what is empty is removed.
std::filesystem::path launching_beside(const std::filesystem::path& journal);
Unfinished read_unfinished(const std::filesystem::path& path);
Expected<void> write_unfinished(const std::filesystem::path& path, const Unfinished& unfinished);

// Who keeps it.
struct LaunchKeeper {
  Unfinished left{};           // by a culprit that was killed
  bool starts_missing = true;  // else only what was left is brought up
  // Whether culprit, or one before it, started the component, and it runs.
  std::function<bool(ComponentId)> runs = [](ComponentId) { return false; };
  std::function<void(const Unfinished&)> keep = [](const Unfinished&) {};
  History past{};  // how components came up before (CameUp)
};

// For the manager to begin with.
struct Launched {
  // What was observed. Of lifecycles only where they are now: how they got there was a start.
  std::vector<Observation> seen;
  std::vector<KnownRobot::Part> parts;  // what was started, and so counts as seen
  History past;                         // how it came up
};

// Producers before their consumers, else as the file has them.
std::vector<ComponentId> in_order(const RuleSet& rules);

// Ends early when `stop` is set.
Launched launch(Robot& robot, const RuleSet& rules, const StartComponent& start, Listener& listener,
                const std::atomic<bool>& stop, LaunchTimes times = {},
                const LaunchKeeper& keeper = {});

}  // namespace culprit::live
