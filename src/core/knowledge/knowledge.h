// Everything that the manager knows. Each stage reads all of it, and writes the parts that its
// `Writes` names; only the manager's step touches it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "knowledge/beliefs.h"
#include "knowledge/blindness.h"
#include "knowledge/coincidences.h"
#include "knowledge/component_states.h"
#include "knowledge/couplings.h"
#include "knowledge/departures.h"
#include "knowledge/dependency_graph.h"
#include "knowledge/discovered.h"
#include "knowledge/event_log.h"
#include "knowledge/latencies.h"
#include "knowledge/outcomes.h"
#include "knowledge/reported_names.h"
#include "knowledge/rivals.h"
#include "knowledge/rule_states.h"
#include "knowledge/signal_store.h"
#include "knowledge/transients.h"
#include "language/rule_set.h"

namespace culprit {

struct Knowledge {
  // `rule_set` must outlive the knowledge and keep its address.
  explicit Knowledge(const RuleSet& rule_set);
  // A copy of `other` for `rule_set`, which is a copy of its rules. Its events, and the names that
  // only reports need, are left out.
  Knowledge(const RuleSet& rule_set, const Knowledge& other);
  Knowledge(const Knowledge&) = delete;
  ~Knowledge();

  const RuleSet& rules;
  const std::vector<std::optional<ComponentId>> signal_publishers;  // by signal: publisher_of()
  SignalStore signals;
  DependencyGraph graph;
  ComponentStates components;
  Departures departures;
  Discovered discovered;
  ReportedNames reported_names;
  RuleStates states;
  Blindness blindness;
  Beliefs beliefs;
  Couplings couplings;
  Latencies latencies;
  Coincidences coincidences;
  Transients transients;
  // The governor's reason against an action now.
  struct Withheld {
    std::string reason;            // empty: it is allowed
    Time until = kNever;           // kNever: until somebody does something, or more is known
    bool is_given_up = false;      // was done too often: a person must look
    bool is_contradicted = false;  // what is measured shows that its component works
  };
  using WithheldList = std::vector<Withheld>;  // by strategy
  WithheldList withheld;
  PendingOutcomes outcomes;
  Rivals rivals;
  // The last step of the system clock of culprit's own computer.
  struct ClockStep {
    Time at{};
    Duration by{};  // below 0: it was set back
    // "the system clock of this computer was set back by 1 h: …"
    std::string in_words() const;
  };
  std::optional<ClockStep> clock_step;
  Duration finding{};  // how long a node that began anew may take to find what it reads
  Time now{};          // of the step under way
  EventLog events;

  // The make-up of the robot, for the next run. Changes only with the graph's changes and the
  // counts of first discoveries.
  KnownRobot known_robot() const;

  // The operating system reports that its process exited.
  bool is_known_gone(ComponentId component) const;
  // Does the strategy start such processes, and nothing else? That harms nothing.
  bool only_starts_the_gone(const Strategy& strategy) const;
  // May the strategy be begun though its rule is exhausted? One that starts the gone; and one that was never
  // tried for the failure, because its WHEN was not true.
  bool goes_on(StrategyId strategy) const;

  // Since when it is unknown whether the rule's failure is present; empty: the rule can see.
  std::optional<Time> blind_since(RuleId rule) const {
    const auto& blind = blindness[rule];
    return blind ? std::optional(blind->since) : std::nullopt;
  }

  // A topic that only this component publishes, and whose last message came when it was due.
  std::optional<TopicId> heard_topic(ComponentId component, Time at) const;

  // When the component, or something that it depends on, last joined the graph.
  Time began(ComponentId component) const;

  // It was seen, and its computer is unreachable, or was until a moment ago; or its owner there cannot
  // be asked, and it is not known to work; or its simulated time stands still. Its state is unknown: culprit does nothing about it, and
  // learns nothing from it.
  bool is_unheard(ComponentId component) const;
  // The name of that computer, for people: "rover2".
  std::string host_of(ComponentId component) const;
  // Why the state of such a component is unknown: "is on rover2, which is unreachable", "uses simulated
  // time, which stands still".
  std::string why_unheard(ComponentId component) const;
  // The component on an unreachable computer that the rule touches, or that a component of the rule
  // depends on. Empty: there is none, or the failure was there long before, or the operating system
  // reports a crash of its own.
  std::optional<ComponentId> unheard_behind(RuleId rule) const;
  // Was the failure detected so long before that computer became unreachable that this cannot be its
  // cause?
  bool is_older_than_silence(RuleId rule, ComponentId unheard) const;

  // When the inputs of each of the components can have arrived at the latest, since it or its
  // dependencies began anew: its middleware has to discover them first, and they have to publish again.
  // kNever: one of those is not there. kLongAgo: none of them reads anything.
  Time can_hear_from(std::span<const ComponentId> components) const;
};

}  // namespace culprit
