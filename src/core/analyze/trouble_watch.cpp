#include "analyze/trouble_watch.h"

#include <algorithm>

#include "diagnose/trouble.h"

namespace culprit {

void TroubleWatch::look(Time now, bool is_any_failing) {
  if (!is_any_failing) {
    open_.clear();
    over_.clear();
    return;
  }
  const auto troubles = diagnose::all_troubles(knowledge_);
  withdraw();
  std::erase_if(open_, [&](Open& each) {
    const auto& trouble = troubles[each.component.index];
    const bool is_over = !trouble;
    if (trouble && !trouble->topic) each.topic.reset();  // its process was replaced, say
    // The state of a component on an unreachable computer is not known.
    if (is_over && !knowledge_.is_unheard(each.component)) close(each, now);
    return is_over;
  });
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const bool is_open = std::ranges::find(open_, ComponentId(c), &Open::component) != open_.end();
    if (troubles[c] && !is_open)
      open_.push_back({ComponentId(c), troubles[c]->onset.earliest, troubles[c]->topic});
  }
}

void TroubleWatch::close(const Open& trouble, Time now) {
  if (trouble.topic) {
    if (!is_over(trouble)) return;
    over_.push_back(trouble);
  }
  components_[trouble.component].past_trouble = PastTrouble{trouble.since, now};
}

bool TroubleWatch::is_over(const Open& silence) const {
  const auto& last = knowledge_.signals.rhythm(*silence.topic).silence;
  return last && last->since == silence.since;
}

// Forgets the ends of silences that were none, and those that the next message has confirmed.
void TroubleWatch::withdraw() {
  std::erase_if(over_, [&](const Open& each) {
    auto& past = components_[each.component].past_trouble;
    const SignalStore::Rhythm& rhythm = knowledge_.signals.rhythm(*each.topic);
    if (is_over(each)) return *rhythm.last != rhythm.silence->over;
    if (past && past->since == each.since) past.reset();
    return true;
  });
}

}  // namespace culprit
