#include "plan/bayes/connected_parts.h"

#include <numeric>

namespace culprit::plan {

ConnectedParts::ConnectedParts(const Knowledge& knowledge) : knowledge_(knowledge) {
  const Condensation& graph = knowledge.graph.condensation();
  parents_.resize(graph.size() + knowledge.rules.components.size());
  std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  for (Condensation::Scc scc = 0; scc < graph.size(); ++scc) {
    for (const Condensation::Scc producer : graph.producers(scc)) connect(scc, producer);
  }
}

void ConnectedParts::connect(const std::vector<ComponentId>& components) {
  for (const ComponentId c : components) connect(place_of(c), place_of(components.front()));
}

std::size_t ConnectedParts::place_of(ComponentId component) const {
  if (const auto scc = knowledge_.graph.scc_of(component)) return *scc;
  return knowledge_.graph.condensation().size() + component.index;
}

// Halves the path on the way, so that trees stay flat.
std::size_t ConnectedParts::root(std::size_t place) {
  while (parents_[place] != place) {
    parents_[place] = parents_[parents_[place]];
    place = parents_[place];
  }
  return place;
}

}  // namespace culprit::plan
