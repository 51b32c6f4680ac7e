#include "diagnose/lost.h"

#include <cmath>

#include "base/units.h"

namespace culprit::diagnose {
namespace {

using Kind = Input::Kind;

std::optional<ComponentId> publisher_of(TopicId topic, const Knowledge& knowledge) {
  const std::string& name = knowledge.rules[topic].name;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    if (knowledge.graph.publishes(ComponentId(c), name)) return ComponentId(c);
  }
  return std::nullopt;
}

}  // namespace

bool may_be_lost(TopicId topic, Time now, const Knowledge& knowledge) {
  const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(topic);
  if (rhythm.loss_at_most <= 0 || !rhythm.last || rhythm.interval <= Duration::zero()) return false;
  const double missed = seconds(now - rhythm.silent_since()) / seconds(rhythm.interval);
  return missed >= 1 && std::pow(rhythm.loss_at_most, missed) >= kPlausible;
}

std::optional<Lost> lost_behind(RuleId failure, const Knowledge& knowledge) {
  for (const InputId id : knowledge.rules[failure].inputs) {
    const Input& input = knowledge.rules[id];
    const bool is_pause =
        input.kind == Kind::kAge || input.kind == Kind::kPhi || input.kind == Kind::kRate;
    if (!is_pause || !may_be_lost(input.topic, knowledge.now, knowledge)) continue;
    if (const auto publisher = publisher_of(input.topic, knowledge))
      return Lost{*publisher, input.topic, knowledge.signals.rhythm(input.topic).loss};
  }
  return std::nullopt;
}

std::string in_words(const Lost& lost, const Knowledge& knowledge) {
  return "answers, and " + std::to_string(std::lround(100 * lost.share)) +
         " % of what it sends on " + knowledge.rules[lost.topic].name +
         " is lost on the way to culprit: the network or a host is at fault";
}

}  // namespace culprit::diagnose
