#include "plan/bayes/surroundings.h"

#include <algorithm>

#include "plan/bayes/suspicion.h"

namespace culprit::plan {
namespace {

constexpr std::size_t kLevels = 3;

std::size_t level_of(RuleId rule, const Knowledge& knowledge) {
  return static_cast<std::size_t>(knowledge.rules[rule].policies.criticality);
}

}  // namespace

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
  return std::max<Duration>(duration_of(kLongestWait, knowledge.rules),
                            kLongestWaitLatencies * knowledge.signals.latency(suspicious));
}

std::vector<RuleId> suspicious_rules(std::span<const RuleId> failures, const Knowledge& knowledge) {
  Time latest = kLongAgo;
  for (const RuleId f : failures) latest = std::max(latest, knowledge.states[f].failing_since);
  std::vector<RuleId> suspicious;
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const RuleId rule(r);
    const bool is_over = knowledge.now >= later(latest, longest_wait(rule, knowledge));
    if (!is_over && is_suspicious(rule, knowledge)) suspicious.push_back(rule);
  }
  return suspicious;
}

std::vector<ComponentId> components_of_interest(const Knowledge& knowledge,
                                                std::span<const RuleId> suspicious) {
  std::vector<ComponentId> all;
  const auto add = [&](RuleId rule) {
    const auto& touched = knowledge.rules[rule].components;
    all.insert(all.end(), touched.begin(), touched.end());
  };
  std::for_each(knowledge.states.active().begin(), knowledge.states.active().end(), add);
  std::for_each(suspicious.begin(), suspicious.end(), add);
  return all;
}

Surroundings::Surroundings(const Knowledge& knowledge, const Reach& reach,
                           std::span<const RuleId> failures, std::span<const RuleId> suspicious)
    : knowledge_(knowledge),
      reach_(reach),
      holding_(kLevels, Marks(reach.size())),
      urgent_(kLevels, Marks(reach.size())),
      planned_(kLevels, Marks(reach.size())),
      judged_(kLevels, Marks(reach.size())),
      pending_(kLevels, Marks(reach.size())),
      suspects_(kLevels, Marks(reach.size())),
      added_(reach.size()) {
  const auto mark = [&](Marks& marks, const std::vector<ComponentId>& components, RuleId rule) {
    for (const ComponentId c : components) marks.mark(reach.place_of(c), rule);
  };
  const auto mark_below = [&](std::vector<Marks>& marks, RuleId rule) {
    for (std::size_t below = 0; below < level_of(rule, knowledge); ++below)
      mark(marks[below], knowledge.rules[rule].components, rule);
  };
  for (const RuleId rule : knowledge.states.active()) {
    const auto& attempt = knowledge.states[rule].attempt;
    if (!attempt) continue;
    const auto& adapted = knowledge.rules[attempt->strategy].components;
    const bool has_effect = attempt->stage == Attempt::Stage::kWaiting;
    mark_below(has_effect ? judged_ : urgent_, rule);
    for (std::size_t level = 0; level < kLevels; ++level) {
      if (!has_effect || level <= level_of(rule, knowledge)) mark(holding_[level], adapted, rule);
    }
  }
  for (const RuleId rule : failures) mark_below(planned_, rule);
  for (const RuleId rule : suspicious) {
    patience_ = std::max(patience_, longest_wait(rule, knowledge));
    mark_below(pending_, rule);
    for (std::size_t level = 0; level <= level_of(rule, knowledge); ++level)
      mark(suspects_[level], knowledge.rules[rule].components, rule);
  }
}

std::optional<Surroundings::Obstacle> Surroundings::reserved(const Strategy& strategy) const {
  const Marks& marks = holding_[level_of(strategy.rule, knowledge_)];
  for (const ComponentId c : strategy.components) {
    const std::size_t place = reach_.place_of(c);
    if (has(marks.bits(), place)) return Obstacle{Condition::kAdapting, c, marks.failure[place]};
  }
  return std::nullopt;
}

std::optional<Surroundings::Obstacle> Surroundings::obstacle(std::size_t place,
                                                             const Strategy& strategy,
                                                             double chance) const {
  const std::size_t level = level_of(strategy.rule, knowledge_);
  if (auto held = found(Condition::kDownstream, reach_.upstream(place), holding_[level]))
    return held;
  const bool needs_no_verdict = chance >= kSure && !takes_down(strategy);
  if (knowledge_.now < later(knowledge_.states[strategy.rule].failing_since, patience_)) {
    if (auto pending = found(Condition::kSuspect, reach_.upstream(place), suspects_[level]))
      return pending;
    auto pending = in_the_way(place, pending_[level]);
    if (pending && !needs_no_verdict) return pending;
  }
  if (auto urgent = in_the_way(place, urgent_[level])) return urgent;
  // What is sure and takes nothing down is over before they would have their turn downstream.
  if (auto next = in_the_way(place, planned_[level])) {
    if (!needs_no_verdict || has(planned_[level].bits(), place)) return next;
  }
  return takes_down(strategy) ? in_the_way(place, judged_[level]) : std::nullopt;
}

// Does what is at `place`, or depends on it, belong to one of the failures?
std::optional<Surroundings::Obstacle> Surroundings::in_the_way(std::size_t place,
                                                               const Marks& marks) const {
  if (has(marks.bits(), place))
    return Obstacle{Condition::kInTheWay, reach_[place], marks.failure[place]};
  return found(Condition::kInTheWay, reach_.downstream(place), marks);
}

void Surroundings::add(const Strategy& strategy) {
  for (const ComponentId c : strategy.components) added_.mark(reach_.place_of(c), strategy.rule);
}

std::optional<Surroundings::Obstacle> Surroundings::conflict(std::size_t place) const {
  if (has(added_.bits(), place))
    return Obstacle{Condition::kAffected, reach_[place], added_.failure[place]};
  if (auto upstream = found(Condition::kDownstream, reach_.upstream(place), added_))
    return upstream;
  return found(Condition::kInTheWay, reach_.downstream(place), added_);
}

std::optional<Surroundings::Obstacle> Surroundings::found(Condition condition,
                                                          std::span<const Word> where,
                                                          const Marks& marks) const {
  const auto place = first_common(where, marks.bits());
  if (!place) return std::nullopt;
  return Obstacle{condition, reach_[*place], marks.failure[*place]};
}

}  // namespace culprit::plan
