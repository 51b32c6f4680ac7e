#include "diagnose/touched.h"

#include <algorithm>

#include "diagnose/timing.h"

namespace culprit::diagnose {
namespace {

void sort_unique(std::vector<ComponentId>& all) {
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

// Those that alone publish what the rule reads: what a rule without strategies is about.
std::vector<ComponentId> publishers_read(const Rule& rule, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<ComponentId> all;
  for (const InputId id : rule.inputs) {
    const Input& input = rules[id];
    const auto* field = input.kind == Input::Kind::kSignal
                            ? std::get_if<TopicField>(&rules[input.signal].source)
                            : nullptr;
    std::optional<ComponentId> publisher;
    if (field != nullptr || watches_a_topic(input)) {
      publisher =
          knowledge.graph.only_publisher(rules[field != nullptr ? field->topic : input.topic]);
    } else if (input.kind == Input::Kind::kSignal) {
      publisher = publisher_of(input.signal, rules);
    }
    if (publisher) all.push_back(*publisher);
  }
  sort_unique(all);
  return all;
}

}  // namespace

std::vector<ComponentId> touched_by(RuleId rule, const Knowledge& knowledge) {
  const Rule& of = knowledge.rules[rule];
  std::vector<ComponentId> touched;
  for (const StrategyId id : of.strategies) {
    const Strategy& strategy = knowledge.rules[id];
    if (strategy.is_last_resort) continue;
    touched.insert(touched.end(), strategy.components.begin(), strategy.components.end());
  }
  if (touched.empty() && of.components.empty()) return publishers_read(of, knowledge);
  if (touched.empty()) return of.components;
  sort_unique(touched);
  return touched;
}

}  // namespace culprit::diagnose
