#include "diagnose/awaited.h"

#include <algorithm>

namespace culprit::diagnose {
namespace {

std::size_t at(Symptom symptom) { return static_cast<std::size_t>(symptom); }

// When the rule's failure was really over.
Time recovered(RuleId rule, const Knowledge& knowledge) {
  return knowledge.states[rule].gone_since - knowledge.latencies.lateness(rule).presumed;
}

bool cleared_lately(RuleId rule, const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[rule];
  return state.phase == RulePhase::kQuiet && state.gone_since != kLongAgo &&
         knowledge.now < later(state.gone_since, kLongestEvidence);
}

}  // namespace

void Awaited::Two::add(const Best& other) {
  if (!other.rule) return;
  if (first.rule == other.rule) {
    first.within = std::max(first.within, other.within);
  } else if (!first.rule || other.within > first.within) {
    second = first;
    first = other;
  } else if (!second.rule || other.within > second.within) {
    second = other;
  }
}

void Awaited::Two::add(const Two& other) {
  add(other.first);
  add(other.second);
}

const Awaited::Best& Awaited::Two::without(RuleId rule) const {
  return first.rule == rule ? second : first;
}

Awaited::Awaited(const Knowledge& knowledge, std::span<const RuleId> failures)
    : knowledge_(knowledge) {
  const bool is_any_new = std::any_of(failures.begin(), failures.end(), [&](RuleId rule) {
    return knowledge.now < later(knowledge.states[rule].failing_since, 2 * kLongestEvidence);
  });
  if (!is_any_new) return;
  Time latest = kLongAgo;
  for (const RuleId failure : failures)
    latest = std::max(latest, onset_of(failure, knowledge).latest);
  collect(latest);
  collect_gone();
  carry();
  for (const RuleId failure : failures) look_at(failure);
}

void Awaited::collect(Time latest_onset) {
  places_.resize(knowledge_.graph.condensation().size());
  is_circle_.resize(places_.size(), false);
  std::vector<bool> is_taken(places_.size(), false);
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    const auto scc = knowledge_.graph.scc_of(ComponentId(c));
    if (!scc) continue;
    if (is_taken[*scc]) is_circle_[*scc] = true;
    is_taken[*scc] = true;
  }
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const RuleId rule(r);
    const Duration within = evidence_within(rule, latest_onset, knowledge_);
    if (within == Duration::zero()) continue;
    const bool is_gone = cleared_lately(rule, knowledge_);
    for (const ComponentId c : knowledge_.rules[rule].components) {
      const auto scc = knowledge_.graph.scc_of(c);
      if (!scc) continue;
      Place& place = places_[*scc];
      auto& own = (is_gone ? place.own_again : place.own)[at(symptom_of(rule, knowledge_))];
      own.add(Best{within, rule});
    }
  }
}

void Awaited::collect_gone() {
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    if (cleared_lately(RuleId(r), knowledge_)) gone_.emplace_back(r);
  }
  own_gone_ = BitRows(places_.size(), gone_.size());
  upstream_gone_ = BitRows(places_.size(), gone_.size());
  for (std::size_t g = 0; g < gone_.size(); ++g) {
    for (const ComponentId c : knowledge_.rules[gone_[g]].components) {
      if (const auto scc = knowledge_.graph.scc_of(c)) set(own_gone_[*scc], g);
    }
  }
}

void Awaited::carry() {
  const Condensation& graph = knowledge_.graph.condensation();
  for (Condensation::Scc scc = 0; scc < places_.size(); ++scc) {
    Place& place = places_[scc];
    for (const Condensation::Scc producer : graph.producers(scc)) {
      const Place& before = places_[producer];
      for (const std::size_t s : {at(Symptom::kOutage), at(Symptom::kValue)}) {
        place.upstream[s].add(before.upstream[s]);
        place.upstream[s].add(before.own[s]);
        place.upstream_again[s].add(before.upstream_again[s]);
        place.upstream_again[s].add(before.own_again[s]);
      }
      add(upstream_gone_[scc], upstream_gone_[producer]);
      add(upstream_gone_[scc], own_gone_[producer]);
    }
  }
}

void Awaited::look_at(RuleId failure) {
  const Awaiting found = awaiting(failure);
  if (knowledge_.now < found.until) found_.emplace_back(failure, found);
}

Awaiting Awaited::awaiting(RuleId failure) const {
  const RuleState& state = knowledge_.states[failure];
  const Time onset = onset_of(failure, knowledge_).latest;
  const Time first_onset = first_onset_of(failure, knowledge_);
  const bool is_value = symptom_of(failure, knowledge_) == Symptom::kValue;
  const Duration lateness = presumed_lateness(failure, knowledge_);
  Awaiting found;
  const auto wait_for = [&](const Two& evidence, Time latest, Time detected) {
    const auto& [within, rule] = evidence.without(failure);
    if (!rule) return;
    const Duration least =
        std::min<Duration>(within, knowledge_.signals.latency(*rule) / 2 + knowledge_.rules.cycle);
    const Time until = std::clamp(later(latest - lateness, within), later(latest, least),
                                  later(detected, kLongestEvidence));
    if (until > found.until) found = {until, *rule, false};
  };
  const auto fade = [&](std::span<const Word> gone) {
    for_each(gone, [&](std::size_t g) {
      const Time until = fades(failure, gone_[g]);
      if (until > found.until) found = {until, gone_[g], true};
    });
  };
  for (const ComponentId c : knowledge_.rules[failure].components) {
    const auto scc = knowledge_.graph.scc_of(c);
    if (!scc) continue;
    const Place& place = places_[*scc];
    for (const Symptom symptom : {Symptom::kOutage, Symptom::kValue}) {
      if (symptom == Symptom::kValue && !is_value) continue;  // no outage comes of a bad value
      const std::size_t s = at(symptom);
      wait_for(place.upstream[s], first_onset, state.first_detected());
      wait_for(place.upstream_again[s], onset, state.failing_since);
      if (!is_circle_[*scc]) continue;
      wait_for(place.own[s], first_onset, state.first_detected());
      wait_for(place.own_again[s], onset, state.failing_since);
    }
    fade(upstream_gone_[*scc]);
    if (is_circle_[*scc]) fade(own_gone_[*scc]);
  }
  return found;
}

Time Awaited::fades(RuleId failure, RuleId gone) const {
  // One reading of a common monitor tells of both: whether it settles is seen by that (Settling).
  const bool is_value = symptom_of(failure, knowledge_) == Symptom::kValue;
  const bool has_echo = is_value ? knowledge_.latencies.is_late(failure)
                                 : symptom_of(gone, knowledge_) == Symptom::kOutage;
  const Onset onset = onset_of(failure, knowledge_);
  const Time passed = later(recovered(gone, knowledge_), duration_of(kPassing, knowledge_.rules));
  const bool can_be =
      onset_of(gone, knowledge_).earliest <= onset.latest && onset.earliest <= passed;
  if (gone == failure || !has_echo || !can_be) return kLongAgo;
  return later(passed, std::min(clears_within(failure, knowledge_), kLongestEvidence));
}

std::optional<Awaiting> Awaited::of(RuleId failure) const {
  const auto found = std::lower_bound(
      found_.begin(), found_.end(), failure,
      [](const std::pair<RuleId, Awaiting>& each, RuleId rule) { return each.first < rule; });
  if (found == found_.end() || found->first != failure) return std::nullopt;
  return found->second;
}

}  // namespace culprit::diagnose
