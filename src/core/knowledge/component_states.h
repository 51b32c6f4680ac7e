// The state of each component itself: its process, its lifecycle, its parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knowledge/coming_up.h"
#include "knowledge/event_log.h"
#include "knowledge/onset.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit {

// "unconfigured", "inactive", "active", "finalized", "unknown", "in transition".
std::string_view to_string(Lifecycle state);

// The result of the probes whether a component answers (Probe), since its process began.
struct Questioned {
  Time at = kLongAgo;                // when it was asked last
  bool is_open = false;              // an answer to that can still come
  std::optional<Time> unanswered{};  // when it was first asked in vain since it answered last
  // It cannot be asked; or it was asked in vain and never answered: it may never do so, by design.
  bool is_pointless = false;
};

// A strategy had it begin anew.
struct BegunAnew {
  StrategyId by;
  Time since{};  // the strategy's first change
  Time done{};   // the component was back
};

// A strategy brought it to another state of its lifecycle.
struct Brought {
  Lifecycle to = Lifecycle::kUnknown;
  // Its process was in another state since: a person, or another program, has changed it.
  bool is_changed = false;
  // It was deactivated, and could not be activated again: when that was undone, or by a restart.
  bool is_owed = false;
  Time since = kLongAgo;  // when that was known, if it is owed
  int tries = 0;          // to activate it again, since then
};

// A trouble (diagnose/trouble.h) that is over: that it was not active, or another that a failure was there
// beside.
struct PastTrouble {
  Time since{};
  Time over{};

  // May what has this onset have begun with it?
  bool may_have_led_to(const Onset& onset) const {
    return since <= onset.latest && onset.earliest <= over;
  }
};

struct ComponentState {
  bool in_graph = false;      // its node is there, and its process is not known to be gone
  Time node_seen = kLongAgo;  // when the node joined the graph last
  // Ends that it had before its process began anew and has not made again are waited for until then.
  Time awaits_ends_until = kLongAgo;
  Time ends_back = kLongAgo;  // when the last of them was there again, or was given up
  int node_pid = 0;           // the process that the node runs in; 0 = not known
  int namesakes = 0;          // other nodes of its name
  ProcessState process = ProcessState::kRunning;  // meaningful if pid is set
  Time process_since = kLongAgo;                  // when that changed last
  int pid = 0;                 // the process that the operating system was asked about
  std::string process_remark;  // how it ended
  // Since when nothing can come from it: its process ended by a fault without saying good-bye, or
  // was stopped, as the operating system says. Set by ComponentStates::set_known_dead().
  std::optional<Time> known_dead{};
  int missed_probes = 0;        // in a row, since it answered last
  Time missed_since{};          // when it was known that the second of them got no answer
  bool answers_probes = false;  // it did, since its process began
  Time answered = kLongAgo;     // when it did so last
  Questioned questioned{};
  Lifecycle lifecycle = Lifecycle::kUnknown;
  Time lifecycle_since = kLongAgo;  // when it was read first in that state
  bool was_active = false;          // it was read as active once
  // Its group was inactive as a whole, which is a pause, and no member was active since.
  bool is_paused = false;
  Time changes_until = kNever;     // when a transition under way hangs; kNever: none is known to be
  Duration transition_patience{};  // that culprit has with each, if more than it needed before
  // The lifecycle state where it should be: the last one while no strategy adapted it, or the one
  // that a strategy brought it to. A process that takes the place of another is brought there,
  // because the state that it comes up in was not chosen.
  Lifecycle intended_lifecycle = Lifecycle::kUnknown;
  Time intended_since = kLongAgo;  // when that changed last
  ComingUp coming_up;              // of the last process that was seen to come up, or as remembered
  bool is_rising = false;          // it was seen unconfigured, and is not active yet
  Time culprit_raised = kLongAgo;  // when culprit took it through its lifecycle last
  Time worked = kLongAgo;          // when its process was last reported to work (ProcessWorked)
  std::optional<Brought> brought{};           // the last time
  std::optional<BegunAnew> begun_anew{};      // likewise
  std::optional<PastTrouble> past_trouble{};  // likewise
  bool took_place = false;  // its process took another's place, and its lifecycle was not read yet

  // Why it cannot be started now (StartBarred); empty: nothing is known to be missing.
  std::string start_missing;

  std::vector<ComponentId> ends_with;  // other components whose processes end with its (EndsWith)

  // Does it work as a process and as a node? Empty until something is known of it.
  std::optional<bool> alive;
  Time alive_since = kLongAgo;  // when that changed last
  bool is_missed = false;       // it was never seen, and had its time to show itself
  // The onset of what keeps it from working, also if that became another trouble meanwhile: it hung, and was killed.
  // Empty: it works, as far as is known. Set by note_trouble().
  std::optional<Onset> troubled{};

  // The other computer that its node ran on last (LivesOn); empty: it was this one, or is not known.
  std::string host;
  // Since when that computer is unreachable (HostHeard). Kept for a while after it is reachable again,
  // until its nodes and their messages are received, too. Set by ComponentStates::set_host_silent().
  std::optional<Time> host_silent{};
  // The computer that runs it cannot be asked (HostReached). Set by ComponentStates::set_out_of_reach().
  bool is_out_of_reach = false;
  // Since when its simulated time stands still (TimeHeld). Set by ComponentStates::set_time_held().
  std::optional<Time> time_held{};

  // Its process runs, or is somewhere else, and it does nothing more.
  bool hangs() const { return in_graph && process == ProcessState::kRunning && alive == false; }

  // To be called after its process, its lifecycle or its being alive may have changed `at` then.
  void note_trouble(Time at) {
    const bool is_managed = lifecycle != Lifecycle::kUnknown;
    const bool works = process == ProcessState::kRunning && alive != false &&
                       (!is_managed || lifecycle == Lifecycle::kActive);
    // Asked in vain since it answered last: it hung already.
    const bool is_overdue = answers_probes && questioned.unanswered.has_value();
    if (works)
      troubled.reset();
    else if (!troubled)
      troubled = Onset{hangs() || is_overdue ? answered : at, at};
  }

  // Though it answers nothing, it may take up a request when it goes on.
  bool may_still_obey() const { return in_graph && process != ProcessState::kGone; }

  // It does nothing that a deactivation would end: it is dead or hangs, or is known not to be active.
  bool is_at_rest() const {
    return alive == false || (alive == true && (lifecycle == Lifecycle::kInactive ||
                                                lifecycle == Lifecycle::kUnconfigured ||
                                                lifecycle == Lifecycle::kFinalized));
  }

  // An earlier strategy has left it deactivated, and nothing else has changed that.
  bool is_to_be_given_back() const { return brought && brought->is_owed && !brought->is_changed; }

  // Is it inactive, as somebody wished at that time already?
  bool is_inactive_since(Time at) const {
    return alive == true && lifecycle == Lifecycle::kInactive &&
           intended_lifecycle == Lifecycle::kInactive && intended_since <= at &&
           !is_to_be_given_back();
  }

  // Its process runs, and its node is not there, or not there yet.
  bool is_coming_up() const { return !in_graph && pid != 0 && process == ProcessState::kRunning; }

  // The process to stop: the node's own, or else the one that was started or adopted.
  int known_pid() const { return node_pid != 0 ? node_pid : pid; }
};

class ComponentStates {
 public:
  explicit ComponentStates(const RuleSet& rules);

  ComponentState& operator[](ComponentId id) { return components_[id.index]; }
  const ComponentState& operator[](ComponentId id) const { return components_[id.index]; }

  // Sets ComponentState::intended_lifecycle, and reports it if it changed.
  void intend_lifecycle(ComponentId component, Lifecycle state, Time at, EventLog& events);
  // Sets ComponentState::coming_up, and reports it if it changed.
  void note_coming_up(ComponentId component, const ComingUp& how, Time at, EventLog& events);

  // A strategy has left it deactivated, or has tried in vain to activate it again.
  void owe_activation(ComponentId component, Time at);
  // Those that may be owed their activation (ComponentState::is_to_be_given_back).
  const std::vector<ComponentId>& owed() const { return owed_; }
  void forget_given_back();

  void set_known_dead(ComponentId component, std::optional<Time> since);
  bool is_any_known_dead() const { return known_dead_ > 0; }

  void set_host_silent(ComponentId component, std::optional<Time> since);
  void set_out_of_reach(ComponentId component, bool is_out_of_reach);
  void set_time_held(ComponentId component, std::optional<Time> since);
  // Is the state of any component unknown because of its computer or its clock
  // (Knowledge::is_unheard)?
  bool is_any_unreached() const { return unreached_ > 0; }
  bool is_any_time_held() const { return times_held_ > 0; }

  // The last value that was read of a parameter; nothing while none was, or since its process began
  // anew.
  std::optional<Value>& operator[](ParameterId id) { return parameters_[id.index]; }
  const std::optional<Value>& operator[](ParameterId id) const { return parameters_[id.index]; }

 private:
  std::vector<ComponentState> components_;
  std::vector<std::optional<Value>> parameters_;
  std::vector<ComponentId> owed_;
  int known_dead_ = 0;  // how many are
  int unreached_ =
      0;  // silent computers, those out of reach and clocks that stand still, by component
  int times_held_ = 0;  // the last of these
};

}  // namespace culprit
