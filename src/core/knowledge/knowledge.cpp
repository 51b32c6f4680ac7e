#include "knowledge/knowledge.h"

#include <algorithm>

namespace culprit {

KnownRobot Knowledge::known_robot() const {
  KnownRobot known;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const ComponentId component(c);
    if (!sightings.has(component)) continue;
    known.parts.push_back(
        {rules[component].name, graph.node_name(component), graph.ends_of(component)});
  }
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    if (sightings.has(TopicId(t))) known.topics.push_back(rules.topics[t].name);
  }
  return known;
}

Time Knowledge::began(ComponentId component) const {
  Time last = components[component].node_seen;
  for (const ComponentId upstream : graph.upstream(component))
    last = std::max(last, components[upstream].node_seen);
  return last;
}

Time Knowledge::can_hear_from(ComponentId component) const {
  if (!graph.reads_others(component)) return kLongAgo;
  const auto has_ends = [](const ComponentState& state) {
    return std::max({state.node_seen, state.ends_back, state.awaits_ends_until});
  };
  Time from = has_ends(components[component]);
  for (const ComponentId upstream : graph.upstream(component)) {
    if (components[upstream].alive == false) return kNever;
    from = std::max(from, has_ends(components[upstream]));
  }
  return later(from, finding);
}

}  // namespace culprit
