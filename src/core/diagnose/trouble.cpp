#include "diagnose/trouble.h"

#include <algorithm>

#include "diagnose/known_down.h"
#include "diagnose/lost.h"
#include "diagnose/questions.h"
#include "diagnose/senders.h"

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

// The trouble follows a silence: it was silent, and was killed.
void follow(TroubleSeen& trouble, const Onset& silence) {
  if (trouble.trouble == Trouble::kNeverSeen || silence.latest >= trouble.onset.earliest) return;
  trouble.onset.earliest = silence.earliest;
  trouble.first_onset = std::min(trouble.first_onset, silence.latest);
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
    if (!component || knowledge.is_unheard(*component)) continue;
    const Onset onset = onset_of_silence(rhythm);
    auto& seen = all[component->index];
    if (seen)
      follow(*seen, onset);
    else
      seen = TroubleSeen{Trouble::kSilent, onset, topic, kNever, onset.earliest};
  }
  const auto stopped = all_stopped(knowledge);
  for (std::size_t c = 0; c < stopped.size(); ++c) {
    const auto& onset = stopped[c];
    if (!onset || knowledge.is_unheard(ComponentId(c))) continue;
    if (all[c])
      follow(*all[c], *onset);
    else
      all[c] = TroubleSeen{Trouble::kSilent, *onset, {}, kNever, onset->earliest};
  }
  return all;
}

}  // namespace culprit::diagnose
