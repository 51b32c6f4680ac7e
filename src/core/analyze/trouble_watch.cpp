#include "analyze/trouble_watch.h"

#include <algorithm>
#include <utility>

#include "diagnose/lost.h"
#include "diagnose/senders.h"
#include "diagnose/trouble.h"

namespace culprit {
void TroubleWatch::look(Time now, bool is_any_failing) {
  if (!is_any_failing) {
    open_.clear();
    over_.clear();
    is_watching_ = false;
    return;
  }
  if (!std::exchange(is_watching_, true)) note_silences_before(now);
  const auto troubles = diagnose::all_troubles(knowledge_);
  withdraw();
  std::erase_if(open_, [&](Open& each) {
    const auto& trouble = troubles[each.component.index];
    const bool is_over = !trouble;
    if (trouble && !trouble->topic) each.topic.reset();  // its process was replaced, say
    if (trouble) each.is_of_values &= trouble->is_of_values();
    // The state of a component on an unreachable computer is not known.
    if (is_over && !knowledge_.is_unheard(each.component)) close(each, now);
    return is_over;
  });
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const bool is_open = std::ranges::find(open_, ComponentId(c), &Open::component) != open_.end();
    if (troubles[c] && !is_open)
      open_.push_back({ComponentId(c), troubles[c]->onset.earliest, troubles[c]->topic,
                       troubles[c]->is_of_values()});
  }
}

// Those that ended just before the first failure was detected.
void TroubleWatch::note_silences_before(Time now) {
  for (std::size_t t = 0; t < knowledge_.rules.topics.size(); ++t) {
    const TopicId topic(t);
    const SignalStore::Rhythm& rhythm = knowledge_.signals.rhythm(topic);
    const auto& silence = rhythm.silence;
    if (!silence || later(silence->over, diagnose::kLongestEvidence) < now || !rhythm.is_steady() ||
        diagnose::may_be_lost(topic, now, knowledge_))
      continue;
    const auto component = knowledge_.graph.only_publisher(knowledge_.rules[topic]);
    if (!component) continue;
    auto& past = components_[*component].past_trouble;
    if (past && past->over >= silence->over) continue;
    over_.push_back({*component, silence->since, topic, false});
    past = PastTrouble{silence->since, silence->over};
  }
}

void TroubleWatch::close(const Open& trouble, Time now) {
  // It answered: it had nothing to tell.
  if (trouble.is_of_values && diagnose::sent_last(trouble.component, knowledge_) <= trouble.since)
    return;
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
