#include "plan/bayes/exclusions.h"

#include <algorithm>
#include <iterator>

#include "plan/also_ended.h"
#include "plan/bayes/seen_down.h"
#include "plan/bayes/suspicion.h"

namespace culprit::plan {

bool takes_down(const Adaptation& adaptation) {
  switch (adaptation.type) {
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kDeactivate:
    case AdaptationType::kStop:
      return true;
    default:
      return false;
  }
}

bool takes_down(const Strategy& strategy) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) { return takes_down(a); });
}

Duration longest_wait(RuleId suspicious, const Knowledge& knowledge) {
  const Duration usual =
      std::max<Duration>(duration_of(kLongestWait, knowledge.rules),
                         kLongestWaitLatencies * knowledge.signals.latency(suspicious));
  // What is known to be dead will not turn out to be well.
  if (!is_seen_down(suspicious, knowledge)) return usual;
  return std::max<Duration>(usual, silence_to_tell(suspicious, knowledge) +
                                       knowledge.rules[suspicious].policies.hold_for +
                                       knowledge.rules.cycle);
}

std::vector<RuleId> awaited(std::span<const RuleId> suspicious, std::span<const RuleId> failures,
                            const Knowledge& knowledge) {
  Time latest = kLongAgo;
  for (const RuleId f : failures) latest = std::max(latest, knowledge.states[f].failing_since);
  std::vector<RuleId> rules;
  std::copy_if(suspicious.begin(), suspicious.end(), std::back_inserter(rules), [&](RuleId rule) {
    return knowledge.now < later(latest, longest_wait(rule, knowledge));
  });
  return rules;
}

std::vector<ComponentId> components_of_interest(const Knowledge& knowledge,
                                                std::span<const RuleId> suspicious) {
  std::vector<ComponentId> all;
  const auto add = [&](RuleId rule) {
    for (const ComponentId c : knowledge.rules[rule].components) {
      const auto& others = knowledge.components[c].ends_with;
      all.push_back(c);
      all.insert(all.end(), others.begin(), others.end());
    }
  };
  std::for_each(knowledge.states.active().begin(), knowledge.states.active().end(), add);
  std::for_each(knowledge.states.exhausted().begin(), knowledge.states.exhausted().end(), add);
  std::for_each(suspicious.begin(), suspicious.end(), add);
  for (std::size_t c = 0;
       knowledge.components.is_any_unreached() && c < knowledge.rules.components.size(); ++c) {
    if (knowledge.is_unheard(ComponentId(c))) all.emplace_back(c);
  }
  return all;
}

Exclusions::Exclusions(const Knowledge& knowledge, const Reach& reach, const Levels& levels,
                       std::span<const RuleId> failures, std::span<const RuleId> suspicious)
    : knowledge_(knowledge),
      reach_(reach),
      levels_(levels),
      holding_(kLevels, Marks(reach.size())),
      urgent_(kLevels, Marks(reach.size())),
      planned_(kLevels, Marks(reach.size())),
      judged_(kLevels, Marks(reach.size())),
      pending_(kLevels, Marks(reach.size())),
      suspects_(reach.size()),
      patience_(reach.size()),
      added_(reach.size()),
      guarded_(reach.size()) {
  const auto mark = [&](Marks& marks, const std::vector<ComponentId>& components, RuleId rule) {
    for (const ComponentId c : components) marks.mark(reach.place_of(c), rule);
  };
  const auto mark_below = [&](std::vector<Marks>& marks, const std::vector<ComponentId>& components,
                              RuleId rule) {
    for (std::size_t below = 0; below < level_of(rule); ++below)
      mark(marks[below], components, rule);
  };
  // While a process is dead, nothing that is done upstream disturbs who replaces it.
  const auto mark_living_below = [&](std::vector<Marks>& marks, RuleId rule) {
    for (const ComponentId c : knowledge.rules[rule].components) {
      for (std::size_t below = 0; below < level_of(rule); ++below) {
        if (!is_seen_down(c, knowledge)) marks[below].mark(reach.place_of(c), rule);
      }
    }
  };
  for (const RuleId rule : knowledge.states.active()) {
    const auto& attempt = knowledge.states[rule].attempt;
    if (!attempt || attempt->stage == Attempt::Stage::kSuspended) continue;
    const Places adapted = affected(knowledge.rules[attempt->strategy]);
    const bool has_effect = attempt->stage == Attempt::Stage::kWaiting;
    if (has_effect) {
      mark_below(judged_, knowledge.rules[rule].components, rule);
    } else {
      mark_living_below(urgent_, rule);
    }
    for (std::size_t level = 0; level < kLevels; ++level) {
      if (has_effect && level > level_of(rule)) continue;
      for (const std::size_t place : adapted) holding_[level].mark(place, rule);
    }
  }
  for (const RuleId rule : failures) mark_living_below(planned_, rule);
  for (const RuleId rule : suspicious) {
    mark_below(pending_, knowledge.rules[rule].components, rule);
    mark(suspects_, knowledge.rules[rule].components, rule);
    for (const ComponentId c : knowledge.rules[rule].components) {
      Duration& patience = patience_[reach.place_of(c)];
      patience = std::max(patience, longest_wait(rule, knowledge));
    }
  }
}

Exclusions::Places Exclusions::affected(const Strategy& strategy) const {
  const std::vector<ComponentId> others = also_ended(strategy, knowledge_);
  Places places;
  places.reserve(strategy.components.size() + others.size());
  for (const ComponentId c : strategy.components) places.push_back(reach_.place_of(c));
  for (const ComponentId c : others) places.push_back(reach_.place_of(c));
  return places;
}

std::optional<Exclusions::Obstacle> Exclusions::reserved(Criticality level,
                                                         const Places& places) const {
  const Marks& marks = holding_[static_cast<std::size_t>(level)];
  for (const std::size_t place : places) {
    if (has(marks.bits(), place))
      return Obstacle{Condition::kAdapting, reach_[place], marks.failure[place]};
  }
  return std::nullopt;
}

std::optional<Exclusions::Obstacle> Exclusions::obstacle(std::size_t place,
                                                         const Strategy& strategy,
                                                         double chance) const {
  const std::size_t level = level_of(strategy.rule);
  if (auto held = found(Condition::kDownstream, reach_.upstream(place), holding_[level]))
    return held;
  if (auto pending = pending_suspicion(place, strategy, chance)) return pending;
  if (auto urgent = in_the_way(place, urgent_[level])) return urgent;
  // What is sure and takes nothing down is over before they would have their turn downstream.
  if (auto next = in_the_way(place, planned_[level])) {
    const bool need_not_wait = chance >= kSure && !takes_down(strategy);
    if (!need_not_wait || has(planned_[level].bits(), place)) return next;
  }
  return takes_down(strategy) ? in_the_way(place, judged_[level]) : std::nullopt;
}

// What looks ill upstream may be the cause; what does at the same component, and is more critical,
// would have to wait. What does downstream may be the effect: nobody waits for it.
std::optional<Exclusions::Obstacle> Exclusions::pending_suspicion(std::size_t place,
                                                                  const Strategy& strategy,
                                                                  double chance) const {
  const Time since = knowledge_.states[strategy.rule].failing_since;
  const auto is_awaited = [&](std::size_t p) {
    return knowledge_.now < later(since, patience_[p]);
  };
  std::optional<Obstacle> suspect;
  for_each_common(reach_.upstream(place), suspects_.bits(), [&](std::size_t p) {
    if (!suspect && is_awaited(p))
      suspect = Obstacle{Condition::kSuspect, reach_[p], suspects_.failure[p]};
  });
  if (suspect) return suspect;
  const Marks& pending = pending_[level_of(strategy.rule)];
  const bool need_not_wait = chance >= kSure && !takes_down(strategy);
  if (need_not_wait || !has(pending.bits(), place) || !is_awaited(place)) return std::nullopt;
  return Obstacle{Condition::kInTheWay, reach_[place], pending.failure[place]};
}

// Does what is at `place`, or depends on it, belong to one of the failures?
std::optional<Exclusions::Obstacle> Exclusions::in_the_way(std::size_t place,
                                                           const Marks& marks) const {
  if (has(marks.bits(), place))
    return Obstacle{Condition::kInTheWay, reach_[place], marks.failure[place]};
  return found(Condition::kInTheWay, reach_.downstream(place), marks);
}

void Exclusions::add(RuleId rule, const Places& places, Disturbance disturbance) {
  for (const std::size_t place : places) {
    added_.mark(place, rule);
    if (disturbance == Disturbance::kFromUpstream) guarded_.mark(place, rule);
  }
}

std::optional<Exclusions::Obstacle> Exclusions::taken(std::size_t place) const {
  if (!has(added_.bits(), place)) return std::nullopt;
  return Obstacle{Condition::kAffected, reach_[place], added_.failure[place]};
}

std::optional<Exclusions::Obstacle> Exclusions::conflict(std::size_t place) const {
  if (auto by_another = taken(place)) return by_another;
  if (auto upstream = found(Condition::kDownstream, reach_.upstream(place), added_))
    return upstream;
  return found(Condition::kInTheWay, reach_.downstream(place), guarded_);
}

std::optional<Exclusions::Obstacle> Exclusions::found(Condition condition,
                                                      std::span<const Word> where,
                                                      const Marks& marks) const {
  const auto place = first_common(where, marks.bits());
  if (!place) return std::nullopt;
  return Obstacle{condition, reach_[*place], marks.failure[*place]};
}

}  // namespace culprit::plan
