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
  std::erase_if(open_, [&](const Open& each) {
    const bool is_over = !troubles[each.component.index];
    // The state of a component on an unreachable computer is not known.
    if (is_over && !knowledge_.is_unheard(each.component)) close(each, now);
    return is_over;
  });
  std::erase_if(over_, [&](const Open& each) {
    return knowledge_.signals.rhythm(*each.topic).last != each.last;
  });
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const bool is_open = std::ranges::find(open_, ComponentId(c), &Open::component) != open_.end();
    if (!troubles[c] || is_open) continue;
    const Time since = troubles[c]->onset.earliest;
    open({ComponentId(c), since, troubles[c]->topic, since});
  }
}

// A silence that begins with the message that ended another one is the same.
void TroubleWatch::open(Open found) {
  const auto before = std::ranges::find(over_, found.component, &Open::component);
  if (found.topic && before != over_.end() && before->topic == found.topic) {
    auto& past = components_[found.component].past_trouble;
    if (past && past->since == before->since) past.reset();
    found.since = before->since;
    over_.erase(before);
  }
  open_.push_back(found);
}

void TroubleWatch::close(Open trouble, Time now) {
  if (trouble.topic) {
    const SignalStore::Rhythm& rhythm = knowledge_.signals.rhythm(*trouble.topic);
    const Duration pause = *rhythm.last - trouble.last;
    if (pause <= diagnose::kSilentGaps * rhythm.gap) return;
    trouble.last = *rhythm.last;
    over_.push_back(trouble);
  }
  components_[trouble.component].past_trouble = PastTrouble{trouble.since, now};
}

}  // namespace culprit
