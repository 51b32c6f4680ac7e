#include "knowledge/knowledge.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "base/duration_words.h"

namespace culprit {
namespace {

bool was_read(const Input& input, const Discovered& discovered) {
  switch (input.subject()) {
    case Input::Subject::kTopic:
      return false;
    case Input::Subject::kComponent:
      return input.kind == Input::Kind::kLifecycle &&
             discovered.was_lifecycle_read(input.component);
    case Input::Subject::kParameter:
      return discovered.was_read(input.parameter);
    case Input::Subject::kDiagnostic:
      return discovered.was_read(input.diagnostic);
    case Input::Subject::kSignal:
      return discovered.was_read(input.signal);
  }
  return false;
}

void note_heard(const Knowledge& knowledge, KnownRobot& known) {
  const RuleSet& rules = knowledge.rules;
  const Discovered& discovered = knowledge.discovered;
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    if (discovered.was_received(TopicId(t)) &&
        knowledge.graph.publisher_count(rules.topics[t]) == 1)
      known.heard.push_back(rules.label(TopicId(t)));
  }
  std::set<std::string> values;
  for (const Input& input : rules.inputs) {
    if (was_read(input, discovered)) values.insert(value_name(input, rules));
  }
  known.read.assign(values.begin(), values.end());
  known.is_whole = discovered.is_whole();
}

std::vector<std::optional<ComponentId>> publishers_of_signals(const RuleSet& rules) {
  std::vector<std::optional<ComponentId>> all;
  for (std::size_t s = 0; s < rules.signals.size(); ++s)
    all.push_back(publisher_of(SignalId(s), rules));
  return all;
}

}  // namespace

Knowledge::Knowledge(const RuleSet& rule_set)
    : rules(rule_set),
      signal_publishers(publishers_of_signals(rules)),
      signals(rules),
      graph(rules),
      components(rules),
      departures(rules),
      discovered(rules),
      states(rules),
      blindness(rules),
      beliefs(rules),
      couplings(rules),
      latencies(rules),
      coincidences(rules),
      transients(rules),
      withheld(rules.strategies.size()) {}

Knowledge::Knowledge(const RuleSet& rule_set, const Knowledge& other)
    : rules(rule_set),
      signal_publishers(other.signal_publishers),
      signals(rules, other.signals),
      graph(other.graph),
      components(other.components),
      departures(other.departures),
      discovered(other.discovered),
      states(rules, other.states),
      blindness(other.blindness),
      beliefs(other.beliefs),
      couplings(other.couplings),
      latencies(other.latencies),
      coincidences(other.coincidences),
      transients(other.transients),
      withheld(other.withheld),
      outcomes(other.outcomes),
      rivals(other.rivals),
      clock_step(other.clock_step),
      finding(other.finding),
      now(other.now) {}

Knowledge::~Knowledge() = default;

std::string Knowledge::ClockStep::in_words() const {
  const bool is_back = by < Duration::zero();
  return "the system clock of this computer was set " + std::string(is_back ? "back" : "ahead") +
         " by " + culprit::in_words(std::chrono::abs(by)) +
         (is_back
              ? ": timers of rclpy, and waits for a time of day, stand still until it has caught "
                "up; a restart of their nodes helps"
              : ": timers that wait until a time of day fire at once");
}

std::string value_name(const Input& input, const RuleSet& rules) {
  switch (input.subject()) {
    case Input::Subject::kTopic:
      return "";
    case Input::Subject::kComponent:
      return input.kind == Input::Kind::kLifecycle ? "lifecycle " + rules[input.component].name
                                                   : "";
    case Input::Subject::kParameter: {
      const Parameter& parameter = rules[input.parameter];
      return "parameter " + rules[parameter.component].name + " " + parameter.name;
    }
    case Input::Subject::kDiagnostic:
      return "diagnostic " + rules.diagnostics[input.diagnostic.index].name;
    case Input::Subject::kSignal:
      return "signal " + rules[input.signal].name;
  }
  return "";
}

KnownRobot Knowledge::known_robot() const {
  KnownRobot known;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const ComponentId component(c);
    if (!discovered.has(component)) continue;
    known.parts.push_back({rules[component].name, graph.node_name(component),
                           graph.ends_of(component), components[component].node_pid,
                           components[component].host});
  }
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    if (discovered.has(TopicId(t))) known.topics.push_back(rules.label(TopicId(t)));
  }
  known.publishers = discovered.publishers();
  note_heard(*this, known);
  return known;
}

bool Knowledge::is_known_gone(ComponentId component) const {
  const ComponentState& state = components[component];
  return state.pid != 0 && state.process == ProcessState::kGone && state.alive == false;
}

// Beside the starts it may change the new processes. A strategy in steps may also find done what an earlier try did for the
// start, pause what depends on it, and take that back.
bool Knowledge::only_starts_the_gone(const Strategy& strategy) const {
  using enum AdaptationType;
  std::vector<ComponentId> started;
  for (const Adaptation& each : strategy.adaptations) {
    if (!launches(each)) continue;
    if (!rules[each.component].can_start() || !is_known_gone(each.component)) return false;
    started.push_back(each.component);
  }
  const auto is_started = [&](ComponentId c) {
    return std::ranges::find(started, c) != started.end();
  };
  const auto is_part_of_it = [&](std::size_t place) {
    const Adaptation& each = strategy.adaptations[place];
    const ComponentId component = each.component;
    if (each.type == kStop) return strategy.has_steps() && is_known_gone(component);
    if (is_started(component) || gives_back(place, strategy)) return true;
    return strategy.has_steps() && each.type == kDeactivate &&
           (components[component].is_at_rest() ||
            std::ranges::any_of(graph.upstream(component), is_started));
  };
  if (started.empty()) return false;
  for (std::size_t place = 0; place < strategy.adaptations.size(); ++place) {
    if (!is_part_of_it(place)) return false;
  }
  return true;
}

bool Knowledge::goes_on(StrategyId id) const {
  const Strategy& strategy = rules[id];
  if (strategy.is_last_resort) return false;
  return only_starts_the_gone(strategy) || (!strategy.when.empty() && !states.was_ever_tried(id));
}

std::optional<TopicId> Knowledge::heard_topic(ComponentId component, Time at) const {
  constexpr Duration kSlack = std::chrono::milliseconds(100);
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = signals.rhythm(TopicId(t));
    if (!rhythm.last || rhythm.interval <= Duration::zero()) continue;
    if (later(*rhythm.last, 2 * rhythm.interval + kSlack) < at) continue;
    const Topic& topic = rules.topics[t];
    if (graph.publishes(component, topic) && graph.publisher_count(topic) == 1) return TopicId(t);
  }
  return std::nullopt;
}

Time Knowledge::began(ComponentId component) const {
  Time last = components[component].node_seen;
  for (const ComponentId upstream : graph.upstream(component))
    last = std::max(last, components[upstream].node_seen);
  return last;
}

bool Knowledge::is_unheard(ComponentId component) const {
  if (!components.is_any_unreached()) return false;
  const ComponentState& state = components[component];
  // Where there is somebody to ask about it, his word counts.
  const bool is_silent = rules[component].has_owner() ? state.is_out_of_reach && state.alive != true
                                                      : state.host_silent.has_value();
  return (is_silent || state.time_held) && state.process == ProcessState::kRunning &&
         discovered.has(component);
}

std::string Knowledge::host_of(ComponentId component) const {
  const std::string& asked = rules[component].host();
  return asked.empty() ? components[component].host : asked;
}

std::string Knowledge::why_unheard(ComponentId component) const {
  if (components[component].time_held) return "uses simulated time, which stands still";
  return "is on " + host_of(component) +
         (rules[component].has_owner() ? ", which cannot be asked" : ", which is unreachable");
}

bool Knowledge::is_older_than_silence(RuleId rule, ComponentId unheard) const {
  // A computer is called silent some seconds after it fell silent.
  constexpr Duration kRecognised = std::chrono::seconds(10);
  // A clock counts as stopped after some of its usual intervals.
  constexpr Duration kClockRecognised = std::chrono::seconds(2);
  const ComponentState& state = components[unheard];
  const Time failing = states[rule].failing_since;
  if (state.time_held && states[rule].phase != RulePhase::kQuiet)
    return later(failing, kClockRecognised) < *state.time_held;
  const auto& since = state.host_silent;
  return since && states[rule].phase != RulePhase::kQuiet && later(failing, kRecognised) < *since;
}

std::optional<ComponentId> Knowledge::unheard_behind(RuleId rule) const {
  if (!components.is_any_unreached()) return std::nullopt;
  const auto& own = rules[rule].components;
  const bool has_dead = std::ranges::any_of(
      own, [&](ComponentId c) { return components[c].process != ProcessState::kRunning; });
  if (has_dead) return std::nullopt;
  const auto is_cause = [&](ComponentId c) {
    return is_unheard(c) && !is_older_than_silence(rule, c);
  };
  for (const ComponentId c : own) {
    if (is_cause(c)) return c;
    const auto& upstream = graph.upstream(c);
    const auto found = std::ranges::find_if(upstream, is_cause);
    if (found != upstream.end()) return *found;
  }
  return std::nullopt;
}

// One search for all: of a large robot most components may depend on what began anew.
Time Knowledge::can_hear_from(std::span<const ComponentId> asked) const {
  std::vector<ComponentId> readers;
  std::copy_if(asked.begin(), asked.end(), std::back_inserter(readers),
               [&](ComponentId c) { return graph.reads_others(c); });
  std::sort(readers.begin(), readers.end());
  Time from = kLongAgo;
  const auto wait_for_ends_of = [&](ComponentId c) {
    const ComponentState& state = components[c];
    from = std::max({from, state.node_seen, state.ends_back, state.awaits_ends_until});
  };
  for (const ComponentId upstream : graph.upstream(readers)) {
    if (components[upstream].alive == false) return kNever;
    wait_for_ends_of(upstream);
  }
  // One of them that is not there itself is missed by another that depends on it.
  const auto is_reader = [&](ComponentId c) {
    return std::binary_search(readers.begin(), readers.end(), c);
  };
  for (const ComponentId reader : readers) {
    if (components[reader].alive == false && graph.first_downstream(reader, is_reader))
      return kNever;
    wait_for_ends_of(reader);
  }
  return readers.empty() ? kLongAgo : later(from, finding);
}

}  // namespace culprit
