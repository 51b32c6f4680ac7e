#include "diagnose/senders.h"

#include <algorithm>

#include "diagnose/lost.h"

namespace culprit::diagnose {
namespace {

bool is_of_signal(const Input& input) { return input.subject() == Input::Subject::kSignal; }

const TopicField* field_of(const Input& input, const Knowledge& knowledge) {
  return is_of_signal(input) ? std::get_if<TopicField>(&knowledge.rules[input.signal].source)
                             : nullptr;
}

// When a value that came regularly has to have come again. Values that are sent on demand pause longer.
Time comes_by(const SignalStore::Arrivals& arrivals) {
  return later(arrivals.last, std::max(5 * arrivals.gap, 2 * arrivals.longest));
}

bool has_stopped(InputId id, const Knowledge& knowledge) {
  const SignalStore::Arrivals& arrivals = knowledge.signals.arrivals(id);
  return arrivals.count == SignalStore::kRegular && knowledge.now > comes_by(arrivals) &&
         knowledge.signals.confirmed_by(id) == kLongAgo;
}

// Does nothing but its own silence speak against the sender?
bool may_be_on_change(const Input& input, ComponentId sender, Time silent_since,
                      const Knowledge& knowledge) {
  const Signal& signal = knowledge.rules[input.signal];
  return std::holds_alternative<DiagnosticKey>(signal.source) && !signal.stale &&
         knowledge.components[sender].answered >= silent_since;
}

// By component.
std::vector<bool> all_that_send(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<bool> all(rules.components.size(), false);
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const TopicId topic(t);
    if (!knowledge.signals.rhythm(topic).last || is_silent(topic, knowledge.now, knowledge))
      continue;
    if (const auto sender = knowledge.graph.only_publisher(rules[topic])) all[sender->index] = true;
  }
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    const InputId id(i);
    if (!is_of_signal(rules[id]) || has_stopped(id, knowledge)) continue;
    if (const auto sender = sender_of(rules[id], knowledge)) all[sender->index] = true;
  }
  return all;
}

}  // namespace

std::optional<ComponentId> sender_of(const Input& input, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  if (const TopicField* field = field_of(input, knowledge))
    return knowledge.graph.only_publisher(rules[field->topic]);
  if (watches_a_topic(input)) return knowledge.graph.only_publisher(rules[input.topic]);
  return is_of_signal(input) ? knowledge.signal_publishers[input.signal.index] : std::nullopt;
}

Time sent_last(ComponentId component, const Knowledge& knowledge) {
  Time last = kLongAgo;
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(TopicId(t));
    if (rhythm.last && rhythm.is_steady() &&
        knowledge.graph.only_publisher(knowledge.rules[TopicId(t)]) == component)
      last = std::max(last, *rhythm.last);
  }
  for (std::size_t i = 0; i < knowledge.rules.inputs.size(); ++i) {
    const Input& input = knowledge.rules[InputId(i)];
    if (is_of_signal(input) && sender_of(input, knowledge) == component)
      last = std::max(last, knowledge.signals.arrivals(InputId(i)).last);
  }
  return last;
}

bool is_publishing(ComponentId component, const Knowledge& knowledge) {
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const TopicId topic(t);
    if (knowledge.signals.rhythm(topic).last && !is_silent(topic, knowledge.now, knowledge) &&
        knowledge.graph.only_publisher(knowledge.rules[topic]) == component)
      return true;
  }
  return false;
}

std::vector<std::optional<Onset>> all_stopped(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<std::optional<Onset>> all(rules.components.size());
  std::vector<bool> send;  // most plans are made while all values come
  for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
    const InputId id(i);
    const Input& input = rules[id];
    if (!is_of_signal(input) || !has_stopped(id, knowledge)) continue;
    const auto sender = sender_of(input, knowledge);
    if (!sender || all[sender->index]) continue;
    if (send.empty()) send = all_that_send(knowledge);
    const TopicField* field = field_of(input, knowledge);
    const bool is_lost = field != nullptr && may_be_lost(field->topic, knowledge.now, knowledge);
    const SignalStore::Arrivals& arrivals = knowledge.signals.arrivals(id);
    if (send[sender->index] || is_lost ||
        may_be_on_change(input, *sender, comes_by(arrivals), knowledge))
      continue;
    all[sender->index] = Onset{arrivals.last, later(arrivals.last, arrivals.gap)};
  }
  return all;
}

}  // namespace culprit::diagnose
