#include "diagnose/trouble.h"

#include <algorithm>

#include "diagnose/known_down.h"
#include "diagnose/lost.h"
#include "diagnose/questions.h"

namespace culprit::diagnose {
namespace {

Onset at(Time since) { return {since, since}; }

// `published` is that of all components, once one of them hangs: it takes a look at each topic.
std::optional<TroubleSeen> present_trouble(ComponentId component, std::vector<Time>& published,
                                           const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[component];
  if (state.process == ProcessState::kGone)
    return TroubleSeen{Trouble::kExited, at(state.process_since)};
  if (state.process == ProcessState::kStopped)
    return TroubleSeen{Trouble::kStopped, at(state.process_since)};
  if (!knowledge.discovered.has(component)) return TroubleSeen{Trouble::kNeverSeen, at(kLongAgo)};
  if (state.hangs() || is_overdue(component, knowledge)) {
    if (published.empty()) published = published_last(knowledge);
    return TroubleSeen{Trouble::kHung, onset_of_hang(state, published[component.index])};
  }
  if (state.alive == false) return TroubleSeen{Trouble::kLeft, at(state.alive_since)};
  // When it went down is not known.
  if (state.is_coming_up()) return TroubleSeen{Trouble::kStarting, {kLongAgo, state.process_since}};
  const bool is_managed = state.lifecycle != Lifecycle::kUnknown;
  if (is_managed && state.lifecycle != Lifecycle::kActive)
    return TroubleSeen{state.was_active ? Trouble::kNotActive : Trouble::kNotYetActive,
                       at(state.lifecycle_since)};
  return std::nullopt;
}

// A trouble that follows another one goes back to the onset of that: what needed the component did not work since.
std::optional<TroubleSeen> own_trouble(ComponentId component, std::vector<Time>& published,
                                       const Knowledge& knowledge) {
  auto seen = present_trouble(component, published, knowledge);
  const auto& first = knowledge.components[component].troubled;
  if (seen) seen->began = seen->onset.earliest;
  if (seen && first) {
    seen->onset.earliest = std::min(seen->onset.earliest, first->earliest);
    seen->first_onset = first->latest;
  }
  return seen;
}

std::optional<ComponentId> sender_of(SignalId signal, const Knowledge& knowledge) {
  const auto* field = std::get_if<TopicField>(&knowledge.rules[signal].source);
  return field != nullptr ? knowledge.graph.only_publisher(knowledge.rules[field->topic])
                          : publisher_of(signal, knowledge.rules);
}

// Values that are sent on demand pause longer.
bool has_stopped(InputId id, const Knowledge& knowledge) {
  const SignalStore::Arrivals& arrivals = knowledge.signals.arrivals(id);
  const Duration usual = std::max(5 * arrivals.gap, 2 * arrivals.longest);
  return arrivals.count == SignalStore::kRegular && knowledge.now > later(arrivals.last, usual) &&
         knowledge.signals.confirmed_by(id) == kLongAgo;
}

// Does anything else come from it that culprit watches?
bool still_sends(ComponentId component, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const TopicId topic(t);
    if (knowledge.signals.rhythm(topic).last && !is_silent(topic, knowledge.now, knowledge) &&
        knowledge.graph.only_publisher(rules[topic]) == component)
      return true;
  }
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    const InputId id(i);
    if (rules[id].subject() == Input::Subject::kSignal && !has_stopped(id, knowledge) &&
        sender_of(rules[id].signal, knowledge) == component)
      return true;
  }
  return false;
}

// The one whose values the input has, if all that it sends has stopped.
std::optional<ComponentId> silent_sender(InputId id, const Knowledge& knowledge) {
  const Input& input = knowledge.rules[id];
  if (input.subject() != Input::Subject::kSignal || !has_stopped(id, knowledge))
    return std::nullopt;
  const auto* field = std::get_if<TopicField>(&knowledge.rules[input.signal].source);
  if (field != nullptr && may_be_lost(field->topic, knowledge.now, knowledge)) return std::nullopt;
  const auto sender = sender_of(input.signal, knowledge);
  return sender && !still_sends(*sender, knowledge) ? sender : std::nullopt;
}

}  // namespace

std::string_view to_string(Trouble trouble) {
  switch (trouble) {
    case Trouble::kExited:
      return "exited";
    case Trouble::kStopped:
      return "is stopped";
    case Trouble::kLeft:
      return "left the graph";
    case Trouble::kStarting:
      return "is being started";
    case Trouble::kHung:
      return "hangs";
    case Trouble::kNotActive:
    case Trouble::kNotYetActive:
      return "is not active";
    case Trouble::kNeverSeen:
      return "was never seen";
    case Trouble::kSilent:
      return "is silent";
  }
  return "";
}

bool answers_nothing(Trouble trouble) {
  switch (trouble) {
    case Trouble::kExited:
    case Trouble::kStopped:
    case Trouble::kLeft:
    case Trouble::kStarting:
    case Trouble::kHung:
    case Trouble::kNeverSeen:
      return true;
    case Trouble::kNotActive:
    case Trouble::kNotYetActive:
    case Trouble::kSilent:
      return false;
  }
  return false;
}

std::optional<TroubleSeen> trouble_of(ComponentId component, const Knowledge& knowledge) {
  if (knowledge.is_unheard(component)) return std::nullopt;
  std::vector<Time> published;
  return own_trouble(component, published, knowledge);
}

std::vector<std::optional<TroubleSeen>> all_troubles(const Knowledge& knowledge) {
  std::vector<std::optional<TroubleSeen>> all;
  all.reserve(knowledge.rules.components.size());
  std::vector<Time> published;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const ComponentId component(c);
    all.push_back(knowledge.is_unheard(component) ? std::nullopt
                                                  : own_trouble(component, published, knowledge));
  }
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const TopicId topic(t);
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(topic);
    if (!is_silent(topic, knowledge.now, knowledge) || !rhythm.is_steady() ||
        may_be_lost(topic, knowledge.now, knowledge))
      continue;
    const auto component = knowledge.graph.only_publisher(knowledge.rules[topic]);
    if (!component || all[component->index] || knowledge.is_unheard(*component)) continue;
    const Onset onset{*rhythm.last, later(rhythm.silent_since(), rhythm.gap)};
    all[component->index] = TroubleSeen{Trouble::kSilent, onset, topic, kNever, onset.earliest};
  }
  for (std::size_t i = 0; i < knowledge.rules.inputs.size(); ++i) {
    const auto component = silent_sender(InputId(i), knowledge);
    if (!component || all[component->index] || knowledge.is_unheard(*component)) continue;
    const SignalStore::Arrivals& arrivals = knowledge.signals.arrivals(InputId(i));
    const Onset onset{arrivals.last, later(arrivals.last, arrivals.gap)};
    all[component->index] = TroubleSeen{Trouble::kSilent, onset, {}, kNever, onset.earliest};
  }
  return all;
}

}  // namespace culprit::diagnose
