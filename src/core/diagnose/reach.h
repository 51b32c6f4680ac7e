// Which of a few components of a large graph are upstream of which others.
//
// One pass over the condensed graph, producers first, carries 64 components at once to all their
// consumers: with e edges and n components that is e * n / 64 steps, whatever the paths are.
#pragma once

#include <vector>

#include "base/invariant.h"
#include "diagnose/bit_rows.h"
#include "knowledge/condensation.h"
#include "knowledge/knowledge.h"

namespace culprit::diagnose {

class Reach {
 public:
  // In the whole graph. `components` may hold some more than once.
  Reach(const Knowledge& knowledge, std::vector<ComponentId> components);
  // In another: `SCCs` says for each component of the rule set where it is.
  using Sccs = std::vector<std::optional<Condensation::Scc>>;
  Reach(const Condensation& graph, const Sccs& sccs, std::vector<ComponentId> components);

  std::size_t size() const { return components_.size(); }
  ComponentId operator[](std::size_t place) const { return components_[place]; }
  bool holds(ComponentId component) const { return places_[component.index] != kAbsent; }
  // @pre it is one of the components
  std::size_t place_of(ComponentId component) const {
    CULPRIT_ASSERT(holds(component));
    return places_[component.index];
  }

  // The places of those that `place` depends on: itself only through a loop.
  std::span<const Word> upstream(std::size_t place) const { return upstream_[place]; }
  std::span<const Word> downstream(std::size_t place) const { return downstream_[place]; }

  // How many components of the whole graph depend on it.
  std::size_t dependents(std::size_t place) const { return dependents_[place]; }

 private:
  static constexpr std::uint32_t kAbsent = static_cast<std::uint32_t>(-1);

  std::vector<ComponentId> components_;  // ascending, each once
  std::vector<std::uint32_t> places_;    // in components_, by ComponentId
  BitRows upstream_;
  BitRows downstream_;
  std::vector<std::size_t> dependents_;
};

}  // namespace culprit::diagnose
