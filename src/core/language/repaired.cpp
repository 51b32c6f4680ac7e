#include "language/repaired.h"

#include <algorithm>
#include <iterator>

namespace culprit {
namespace {

// Does the strategy only deactivate the component, and activate it again later?
bool only_pauses(const Strategy& strategy, ComponentId component) {
  bool is_down = false;
  for (const Adaptation& a : strategy.adaptations) {
    if (a.component != component) continue;
    if (a.type != (is_down ? AdaptationType::kActivate : AdaptationType::kDeactivate)) return false;
    is_down = !is_down;
  }
  return !is_down;
}

}  // namespace

void add_repaired(const Strategy& strategy, std::vector<ComponentId>& to) {
  if (strategy.is_last_resort) return;
  const auto& all = strategy.components;
  const std::size_t before = to.size();
  std::ranges::copy_if(all, std::back_inserter(to), [&](ComponentId c) {
    return !strategy.has_steps() || !only_pauses(strategy, c);
  });
  if (to.size() == before) to.insert(to.end(), all.begin(), all.end());
}

}  // namespace culprit
