// `run --launch`: starts missing components, and brings up nodes that stay inactive after their
// start.
//
// A node counts as a lifecycle node if it offers lifecycle services within 1 s after its other endpoints. Where the file says LIFECYCLE managed, it has 10 s. A
// lifecycle node without a manager stays unconfigured for ever, so culprit configures and activates it: in the order of the DEPENDENCY lines, else in that of
// the file. A node that does so itself, or has another manager, is left alone: the file says so (LIFECYCLE), or the node changed its state within its grace
// period. The grace period is twice the time that it took when another manager brought it up before. It is zero if culprit did, and without a history as long
// as the node's start took. The manager begins only afterwards, so a start of many nodes is no storm. A RESPAWNED component is left to its launcher.
//
// Unfinished launches are kept on disk: if culprit is killed, the next one brings up the components that it had started, also without --launch.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
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

// Unfinished launches: components by name, and whether culprit has begun to take it through its lifecycle. If so, its current state is no intention.
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
  History past{};                     // how components came up before (CameUp)
  std::set<ComponentId> stay_down{};  // a person ended them: neither started nor brought up
};

// For the manager to begin with.
struct Launched {
  // The observations. Lifecycles only by their current state: the transitions before it belong to
  // the start.
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
