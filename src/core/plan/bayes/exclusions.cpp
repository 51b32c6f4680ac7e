#include "plan/bayes/exclusions.h"

#include <algorithm>

#include "diagnose/causes.h"
#include "diagnose/known_down.h"
#include "plan/also_ended.h"

namespace culprit::plan {

using namespace diagnose;

bool takes_down(const Adaptation& adaptation) {
  switch (adaptation.type) {
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kDeactivate:
    case AdaptationType::kStop:
      return true;
    case AdaptationType::kActivate:
    case AdaptationType::kStart:
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return false;
}

bool takes_down(const Strategy& strategy) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) { return takes_down(a); });
}

Exclusions::Exclusions(const Knowledge& knowledge, const Examination& found, const Levels& levels,
                       std::span<const RuleId> failures)
    : knowledge_(knowledge),
      troubles_(found.troubles()),
      reach_(found.reach()),
      levels_(levels),
      holding_(kLevels, Marks(reach_.size())),
      urgent_(kLevels, Marks(reach_.size())),
      planned_(kLevels, Marks(reach_.size())),
      judged_(kLevels, Marks(reach_.size())),
      imminent_(kLevels, Marks(reach_.size())),
      added_(reach_.size()),
      guarded_(reach_.size()) {
  const auto mark = [&](Marks& marks, const std::vector<ComponentId>& components, RuleId rule) {
    for (const ComponentId c : components) marks.mark(reach_.place_of(c), rule);
  };
  const auto mark_below = [&](std::vector<Marks>& marks, const std::vector<ComponentId>& components,
                              RuleId rule) {
    for (std::size_t below = 0; below < level_of(rule); ++below)
      mark(marks[below], components, rule);
  };
  // While a process is down, nothing that is done upstream disturbs who replaces it.
  const auto mark_living_below = [&](std::vector<Marks>& marks, RuleId rule) {
    for (const ComponentId c : knowledge.rules[rule].components) {
      for (std::size_t below = 0; below < level_of(rule); ++below) {
        if (!is_known_down(c, knowledge)) marks[below].mark(reach_.place_of(c), rule);
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
  for (const RuleId rule : found.imminent())
    mark_below(imminent_, knowledge.rules[rule].components, rule);
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
  if (auto urgent = in_the_way(place, urgent_[level])) return urgent;
  // A sure strategy that takes nothing down is over before the failures downstream get their turn.
  const bool need_not_wait = chance >= kSure && !takes_down(strategy);
  if (!need_not_wait && has(imminent_[level].bits(), place))
    return Obstacle{Condition::kInTheWay, reach_[place], imminent_[level].failure[place]};
  if (auto next = in_the_way(place, planned_[level])) {
    if (!need_not_wait || has(planned_[level].bits(), place)) return next;
  }
  if (!takes_down(strategy)) return std::nullopt;
  // Without a supplier that is in trouble now, the others can show nothing.
  const auto judged = in_the_way(place, judged_[level]);
  const auto& trouble = troubles_[reach_[place].index];
  const bool hides_it =
      judged && trouble &&
      onset_of(*judged->because, knowledge_).latest <= later(trouble->onset.latest, kUsualDelay);
  return hides_it ? std::nullopt : judged;
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
