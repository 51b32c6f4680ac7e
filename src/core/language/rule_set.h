// A checked rule file: every name looked up, every expression typed and compiled, every number in
// its range.
//
// Things refer to each other by Id, the index into the table of their kind. A rule set is a value
// and never changes once it is checked; what happens at run time is kept by knowledge/.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/goal_status.h"
#include "base/ids.h"
#include "base/log_level.h"
#include "base/seldom.h"
#include "base/units.h"
#include "base/value.h"
#include "language/program.h"
#include "language/syntax.h"

namespace culprit {

using syntax::AdaptationType;
using syntax::Criticality;
using syntax::LifecycleDriver;

// A service that systemd runs.
struct SystemdUnit {
  std::string name;         // "lidar.service"
  bool is_of_user = false;  // of the user's own systemd, not of the system's
  std::string host{};       // the computer, as for ssh: "robot@rover2"; empty: this one
  bool operator==(const SystemdUnit&) const = default;
};

// A container that an engine runs, by name or id.
struct EngineContainer {
  enum class Engine : std::uint8_t { kDocker, kPodman };
  Engine engine = Engine::kDocker;
  std::string name;
  std::string host{};  // as of a unit
  bool operator==(const EngineContainer&) const = default;
};

// How a node is loaded into the process of another one, a component container
// (composition_interfaces).
struct Composition {
  std::string container;              // the node that loads it, by full name
  std::string package;                // that it is registered in
  std::string plugin;                 // "detect::Detector"
  std::string parameters{};           // a file of them, a whole path; may be empty
  std::vector<std::string> remaps{};  // "image:=/camera/image"
  bool operator==(const Composition&) const = default;
};

// A managed ROS 2 node (paper: c in C).
struct Component {
  std::string name;
  std::string node;  // full name; empty: the node of the graph whose own name is `name`
  std::vector<std::string> launch;  // argument vector; empty: culprit cannot start it
  bool declared = true;             // by a COMPONENT line
  bool is_required =
      false;  // a person is notified if it is not there, also if no rule is about that
  LifecycleDriver lifecycle = LifecycleDriver::kUndeclared;
  bool is_respawned =
      false;  // the program that started it starts it again: culprit ends it and waits
  // Starts that end within so long of the first are tries of one start. 0: each is one.
  Duration ready{};

  // Needs of its launch command beyond culprit's own environment and folder. All paths are
  // absolute.
  std::string setup{};                     // a file of shell that is sourced first; may be empty
  std::vector<std::string> environment{};  // "NAME=value"
  std::string folder{};                    // where it runs; empty: where culprit does

  Seldom<SystemdUnit> unit{};  // that runs it: systemd is asked to start and to end it

  Seldom<Composition> composed{};  // its container is asked to load and to unload it

  // More nodes of its process. The component is there while all of them are; `node` is the one that
  // is asked and changed.
  std::vector<std::string> other_nodes{};

  bool has_node(std::string_view full_name) const {
    return node == full_name || std::ranges::find(other_nodes, full_name) != other_nodes.end();
  }

  Seldom<EngineContainer> engine{};  // that runs it: its engine is asked likewise

  // Whether an owner runs it, whose report on its process is proof.
  bool has_owner() const { return unit || engine; }
  // The computer where the owner is asked, over ssh; empty: this one.
  std::string host() const { return unit ? unit->host : engine ? engine->host : ""; }

  // Whether culprit can start it.
  bool can_start() const { return has_owner() || composed || !launch.empty(); }
  // Whether it can be started again after its end, by culprit or another program.
  bool can_start_again() const { return is_respawned || can_start(); }
};

struct Topic {
  std::string name;
  std::optional<ComponentId> publisher{};  // FROM: only what this one publishes
};

// A parameter that the rules read or write.
struct Parameter {
  ComponentId component;
  std::string name;
};

// Components that one lifecycle manager takes through their lifecycles. Its health is a signal that has
// its name (knowledge/group_health.h).
struct Group {
  std::string name;
  std::vector<ComponentId> members;  // in the order in which they are started
  ComponentId manager;
  SignalId health;
};

// A diagnostic status whose level the rules read; `name` is its name or its hardware id.
struct StatusLevel {
  std::string name;
};

struct DiagnosticKey {
  std::string status;  // name or hardware id of the status; "*": any
  std::string key;
  std::optional<ComponentId> publisher{};  // FROM: only what this one publishes
};
struct TopicField {
  TopicId topic;
  std::string field;  // "data", "pose.position.x", "ranges[0]"
};
// Not declared: the key of a diagnostic, or "<hardware id>_<key>" as one name.
struct LookedUp {};

struct Signal {
  std::string name;
  std::variant<DiagnosticKey, TopicField, ParameterId, LookedUp, GroupId> source;
  Type type = Type::kDouble;
  std::optional<Duration> stale;  // older values are unknown
  struct Range {
    double low = 0;
    double high = 0;
    bool operator==(const Range&) const = default;
  };
  std::optional<Range> range;
};

// So many samples of its window an input keeps at most (64 MB). If more come it is unknown.
inline constexpr std::size_t kMaxWindowSamples = std::size_t{1} << 22;

// One value that programs read: a signal as it is, or something that the monitor derives.
struct Input {
  enum class Kind : std::uint8_t {
    kSignal,     // signal
    kRate,       // topic, over window: Hz
    kAge,        // topic: time since the last sample
    kPhi,        // topic: suspicion
    kLoss,       // topic: the share of its messages that was lost on the way to culprit, 0 to 1
    kAlive,      // component
    kLifecycle,  // component: "unconfigured", "inactive", "active", "finalized"
    kParameter,  // parameter
    kLevel,      // diagnostic
    kMean,       // signal, over window
    kMin,
    kMax,
    kStddev,
    kChanged,  // signal: its value became another within the last cycle
    kIsNan,    // signal: its value is not a number
    kFrozen,   // signal: its value stayed as it is for the window, though samples came
    kCpu,      // component: cores that its process uses
    kMemory,   // component: MiB of memory that its process holds
    kGoals,    // topic of an action's status, outcome, over window: goals that ended so
    kGoalAge,  // topic of an action's status: since when its oldest goal runs
    kLogs      // component, log level, over window: lines of its log at that level or above
  };
  // The kind of thing whose value it is; the id of that one is set below.
  enum class Subject : std::uint8_t { kSignal, kTopic, kComponent, kParameter, kDiagnostic };
  constexpr Subject subject() const;

  Kind kind = Kind::kSignal;
  Type type = Type::kDouble;
  TopicId topic;
  SignalId signal;
  ComponentId component;
  ParameterId parameter;
  DiagnosticId diagnostic;
  Duration window{};
  GoalStatus outcome = GoalStatus::kUnknown;  // kGoals
  LogLevel log_level = LogLevel::kError;      // kLogs

  // The constants that this input is compared with anywhere, ascending (durations in seconds).
  // Where the rules use it in no other way (`only_compared`), nothing can change while it moves
  // between two of them.
  std::vector<double> thresholds;
  bool only_compared = true;

  std::vector<RuleId> readers;  // the rules whose trigger reads it
};

constexpr Input::Subject Input::subject() const {
  switch (kind) {
    case Kind::kRate:
    case Kind::kAge:
    case Kind::kPhi:
    case Kind::kLoss:
    case Kind::kGoals:
    case Kind::kGoalAge:
      return Subject::kTopic;
    case Kind::kAlive:
    case Kind::kLifecycle:
    case Kind::kCpu:
    case Kind::kMemory:
    case Kind::kLogs:
      return Subject::kComponent;
    case Kind::kParameter:
      return Subject::kParameter;
    case Kind::kLevel:
      return Subject::kDiagnostic;
    case Kind::kSignal:
    case Kind::kMean:
    case Kind::kMin:
    case Kind::kMax:
    case Kind::kStddev:
    case Kind::kChanged:
    case Kind::kIsNan:
    case Kind::kFrozen:
      break;
  }
  return Subject::kSignal;
}

struct Adaptation {
  ComponentId component;
  AdaptationType type = AdaptationType::kSetParameter;
  std::string subject;        // parameter, mode or service (absolute, or relative to the node)
  ParameterId parameter;      // the same parameter; where there is one
  Program value;              // set, increase and decrease parameter
  std::string topic;          // change_communication
  std::string request{};      // call: what the service is asked, "data: true"; empty: nothing
  Cycles impact;              // paper: i_exec,a
  bool begins_step = false;   // THEN, or it takes back what was done for the one above
  std::uint32_t written = 0;  // the place of its line among those of the strategy
  // start_group: this one brings up a member (activate), or begins the manager anew (redeploy).
  std::optional<GroupId> group{};
};

struct Strategy {
  std::string name;
  RuleId rule;
  Probability success;    // paper: P_s,init
  double confidence = 1;  // paper: c_p, in pseudo-counts
  Program when;           // empty: always
  bool is_last_resort = false;
  Duration
      within{};  // of a last resort: the time that the rule's other strategies have from the detection
  std::vector<Adaptation> adaptations;
  // paper: i_exec,s, the maximum over the adaptations. With steps, the sum of their maxima.
  Cycles impact;
  std::vector<ComponentId> components;  // that it adapts, each once, ascending

  bool has_steps() const {
    return std::ranges::any_of(adaptations, [](const Adaptation& a) { return a.begins_step; });
  }
};

struct Policies {
  Criticality criticality = Criticality::kNonCritical;
  Duration hold_for{};  // FOR
  int hold_needed = 1;  // HOLD n/k, evaluated once per cycle
  int hold_window = 1;
  Duration cooldown{};
  int attempts = 0;  // executions of strategies before the rule is exhausted
  bool on_change = false;
};

struct Rule {
  std::string name;
  Policies policies;
  Program trigger;
  std::vector<StrategyId> strategies;   // in file order
  std::vector<ComponentId> components;  // that its strategies adapt, each once, ascending
  std::vector<InputId> inputs;          // that its trigger reads
  // Those of `components` that it repairs: without what only a last resort adapts, and what a strategy pauses
  // for the sake of others (it deactivates that, and activates it again later).
  std::vector<ComponentId> repaired{};
  // Groups that it is about: its failure is resolved only while each of them is active.
  std::vector<GroupId> groups{};
  syntax::Name declaration;  // where it stands
};

// No strategy begins while the condition is not true.
struct Interlock {
  Program condition;
  std::string text;  // as written
};

// A checked DRILL line.
struct DrillLine {
  using What = syntax::Drill::What;
  ComponentId component;
  What what = What::kLimit;
  std::string subject{};  // parameter, or fault
  Value value{};          // kSetParameter
  std::int64_t times = 0;
};

struct Dependency {
  ComponentId consumer;
  ComponentId producer;
};

struct RuleSet {
  std::string robot;
  Duration cycle = std::chrono::milliseconds(200);
  std::vector<Component> components;
  std::vector<Topic> topics;  // that rules watch
  std::vector<Parameter> parameters;
  std::vector<StatusLevel> diagnostics;
  std::vector<Group> groups;
  std::vector<Signal> signals;
  std::vector<Input> inputs;
  std::vector<Rule> rules;
  std::vector<Strategy> strategies;
  std::vector<Dependency> dependencies;
  std::vector<std::string> ignored_topics;
  std::vector<Interlock> interlocks;
  std::vector<DrillLine> drills;
  std::vector<std::string> aborts;  // conditions that end a drill, as written

  Cycles heaviest;  // paper: i_max, the highest impact of any strategy

  // "/scan", "/scan FROM lidar_front"
  std::string label(TopicId id) const {
    const Topic& topic = topics[id.index];
    return topic.publisher ? topic.name + " FROM " + components[topic.publisher->index].name
                           : topic.name;
  }

  const Component& operator[](ComponentId id) const { return components[id.index]; }
  const Topic& operator[](TopicId id) const { return topics[id.index]; }
  const Group& operator[](GroupId id) const { return groups[id.index]; }
  const Parameter& operator[](ParameterId id) const { return parameters[id.index]; }
  const Signal& operator[](SignalId id) const { return signals[id.index]; }
  const Input& operator[](InputId id) const { return inputs[id.index]; }
  const Rule& operator[](RuleId id) const { return rules[id.index]; }
  const Strategy& operator[](StrategyId id) const { return strategies[id.index]; }
};

// Does it start a process?
inline bool launches(const Adaptation& adaptation) {
  return adaptation.type == AdaptationType::kRedeploy || adaptation.type == AdaptationType::kStart;
}

// Does the adaptation at `place` activate what an earlier step of the strategy deactivates? Then it gives
// back what that one took, and no more: what was not active before stays so.
inline bool gives_back(std::size_t place, const Strategy& strategy) {
  const auto& all = strategy.adaptations;
  const Adaptation& back = all[place];
  return strategy.has_steps() && back.type == AdaptationType::kActivate && !back.group &&
         std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(place),
                     [&](const Adaptation& taken) {
                       return taken.type == AdaptationType::kDeactivate &&
                              taken.component == back.component;
                     });
}

// Does a status of this name come from the component? "camera", "/camera_node", "camera: frame rate".
inline bool is_named_after(std::string_view status, const Component& component) {
  std::string_view name = status.substr(0, status.find(':'));
  if (name.starts_with('/')) name.remove_prefix(1);
  const std::string_view node = component.node;
  return name == component.name || (!node.empty() && name == node.substr(1));
}

// The component that a signal is declared FROM; or that its diagnostic is named after.
inline std::optional<ComponentId> publisher_of(SignalId signal, const RuleSet& rules) {
  const auto& source = rules[signal].source;
  if (const auto* key = std::get_if<DiagnosticKey>(&source)) {
    for (std::size_t c = 0; !key->publisher && c < rules.components.size(); ++c) {
      if (is_named_after(key->status, rules.components[c])) return ComponentId(c);
    }
    return key->publisher;
  }
  if (const auto* field = std::get_if<TopicField>(&source)) return rules[field->topic].publisher;
  return std::nullopt;
}

// Whether components of the rules are loaded into its node.
inline bool is_container(ComponentId component, const RuleSet& rules) {
  const std::string& node = rules[component].node;
  return !node.empty() &&
         std::any_of(rules.components.begin(), rules.components.end(), [&](const Component& c) {
           return c.composed && c.composed->container == node;
         });
}

// The component that loads it; empty: it lives in no container, or no component has that node.
inline std::optional<ComponentId> container_of(ComponentId component, const RuleSet& rules) {
  const auto& composed = rules[component].composed;
  if (!composed) return std::nullopt;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (rules.components[c].node == composed->container && c != component.index)
      return ComponentId(c);
  }
  return std::nullopt;
}

// How long `cycles` last with this rule set.
inline Duration duration_of(Cycles cycles, const RuleSet& rules) {
  return rules.cycle * cycles.count;
}

}  // namespace culprit
