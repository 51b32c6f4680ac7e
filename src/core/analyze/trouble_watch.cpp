#include "analyze/trouble_watch.h"

#include <algorithm>

#include "diagnose/trouble.h"

namespace culprit {

void TroubleWatch::look(Time now, bool is_any_failing) {
  if (!is_any_failing) return open_.clear();
  const auto troubles = diagnose::all_troubles(knowledge_);
  std::erase_if(open_, [&](const Open& each) {
    const bool is_over = !troubles[each.component.index];
    // The state of a component on an unreachable computer is not known.
    if (is_over && !knowledge_.is_unheard(each.component))
      components_[each.component].past_trouble = PastTrouble{each.since, now};
    return is_over;
  });
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const bool is_open = std::ranges::find(open_, ComponentId(c), &Open::component) != open_.end();
    if (troubles[c] && !is_open) open_.push_back({ComponentId(c), troubles[c]->onset.earliest});
  }
}

}  // namespace culprit
