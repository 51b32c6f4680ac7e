// The goals of adaptations: states of a component that are to be reached.
//
// A goal is pursued in three steps: look (is it reached already?), change (one request, never
// repeated), look again until it is reached or the patience is over. Only the value that is read
// back counts, not the answer to the request: a late or lost reply is settled by looking.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "knowledge/knowledge.h"
#include "robot/command.h"

namespace culprit::execute {

struct ParameterGoal {
  std::string name;
  // kSet: `value`, set even if the parameter has it already, because setting may start a routine.
  // kAdd: `value` more than the parameter is now. kRestore: `value`, set only if it is another; and where
  // `left` is given, only if the parameter is that still.
  Value value;
  enum class Kind : std::uint8_t { kSet, kAdd, kRestore } kind = Kind::kSet;
  // Of kSet: what the parameter is known to be. It saves the look before the change, a round trip.
  std::optional<Value> present{};
  std::optional<Value>
      left{};  // of kRestore: what a strategy has set; another value is somebody else's
};
struct LifecycleGoal {
  Lifecycle target = Lifecycle::kActive;
  // A node that was just started may bring itself up: it gets this long before it is told to.
  Duration grace{};
  bool is_left_to_others = false;              // it is never told to
  Duration patience = longest_transition({});  // beyond the grace, for each transition
  // For a node that was just started: it may still be loading. For this long it is asked again if it does
  // not answer, or is not there to be asked.
  Duration loading{};
  // culprit was not yet seen to bring it up. Such a node comes up unconfigured; if it is found further
  // on, another program drives it.
  bool may_have_driver = false;
  // It hangs if it answered before, is in no transition, and answers nothing for so long. Nothing: it may be
  // busy for any time.
  std::optional<Duration> hangs_after{};
};
struct ModeGoal {
  std::string mode;
};
// No state to look at: the routine's answer says whether it succeeded.
struct ServiceGoal {
  std::string service;
  std::string request{};
  Duration answer = std::chrono::seconds(5);  // it may take so long to answer
};
// Reached at once if another process than `pid` has taken its place; 0: whichever is there is
// meant.
struct GoneGoal {
  int pid = 0;
  bool hangs = false;  // it is ended as a process that cannot end politely
};
// `instead_of`: set if the process may have been started already. Then one with another pid will
// do; otherwise one that appears from now on is wanted.
// `instead_of_seen`: the same for a process on another computer, of which only the time is seen when
// its node joined the graph.
struct PresentGoal {
  static constexpr Duration kMost = std::chrono::minutes(5);

  std::optional<int> instead_of{};
  std::optional<Time> instead_of_seen{};
  // From the start; and, while the process works (ProcessWorked), from when it did last, kMost in
  // all.
  Duration patience = std::chrono::seconds(20);
  // While the process that was started is known to run, also if it only waits for something.
  Duration longest = std::chrono::seconds(60);
  Duration answer = std::chrono::seconds(5);  // until the request to start it is answered
  // One that ends before is started again, after kPause, doubled with each try (READY).
  static constexpr Duration kPause = std::chrono::seconds(1);
  Time tries_until = kLongAgo;
  Time not_before = kLongAgo;  // of the first start
};

using Goal =
    std::variant<ParameterGoal, LifecycleGoal, ModeGoal, ServiceGoal, GoneGoal, PresentGoal>;

// How long after the request a goal may take.
Duration patience(const Goal& goal);

// How long a node that was just started is left to the driver that took it through its lifecycle before:
// twice as long as that took, and the impact; 0: culprit was the driver, or it is not known.
Duration grace_of_driver(const Adaptation& adaptation, const Knowledge& knowledge);

// How a node that was just started is brought to `target`: by whom, and how long that may take. To be
// asked for once it is there, too: how long its start took is known only then.
LifecycleGoal bringing_up(const Adaptation& adaptation, Lifecycle target,
                          const Knowledge& knowledge);

// How a member of a GROUP that was found to hang while it was to be brought up is replaced, and brought up.
std::vector<Goal> replacing_hung_member(const Adaptation& adaptation, const Knowledge& knowledge);

// Whether a member of a GROUP that is started is not waited for beyond its process.
bool is_left_to_group(ComponentId component, const Knowledge& knowledge);

// The goals of an adaptation, in order. An error if they cannot be computed: the new value of a
// parameter is unknown now.
Expected<std::vector<Goal>> goals_of(const Adaptation& adaptation, const Knowledge& knowledge);

// Whether it stops a component that culprit can start again.
bool is_undone_by_start(const Adaptation& adaptation, const RuleSet& rules);
// How a component that `stop` ended, when it was `before`, is brought back: the last goal first.
std::vector<Goal> starting_again(const Adaptation& stop, Lifecycle before,
                                 const Knowledge& knowledge);

// How to look at the state that `goal` is about; nothing for goals that the knowledge answers.
using Look = std::variant<ReadParameter, ReadLifecycle, ReadMode>;
std::optional<Look> look_for(const Goal& goal);

// The goal that restores the value from before the change. Empty if a change of this kind is not
// undone, or if that value is no state to go back to: an unknown mode, a number that is none.
std::optional<Goal> undoing(const Goal& goal, AdaptationType type, const Reply& before);

// Whether both are about the same state: one parameter, the lifecycle, the mode.
bool are_of_one_thing(const Goal& a, const Goal& b);

// For people: "exposure = 0.5", "active", "stopped".
std::string describe(const Goal& goal);

}  // namespace culprit::execute
