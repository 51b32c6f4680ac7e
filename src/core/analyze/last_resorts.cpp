#include "analyze/last_resorts.h"

#include <algorithm>
#include <utility>

#include "analyze/backoff.h"
#include "analyze/detector.h"
#include "base/invariant.h"
#include "knowledge/ambiguity.h"

namespace culprit {
namespace {

// A node that was just started may be taken through its lifecycle for so long; later, that is a wish.
constexpr Duration kComesUp = std::chrono::seconds(30);

// Has a process that began since then not got what the last resort changed?
bool is_lost(const Adaptation& adaptation, Time since, const ComponentState& state) {
  const bool comes_up =
      state.lifecycle_since > since && state.lifecycle_since <= later(state.node_seen, kComesUp);
  switch (adaptation.type) {
    case AdaptationType::kDeactivate:
      return comes_up && state.lifecycle == Lifecycle::kActive;
    case AdaptationType::kActivate:
      return comes_up && (state.lifecycle == Lifecycle::kInactive ||
                          state.lifecycle == Lifecycle::kUnconfigured);
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
      return state.node_seen > since;
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return false;
}

// Its changes stay from now on.
void stand(RuleState& state, StrategyId strategy, Time since) {
  std::erase_if(state.standing, [&](const auto& each) { return each.strategy == strategy; });
  state.standing.push_back({strategy, since});
}

// How often it could not be carried out.
int refuse(Search& search, const Attempt& attempt, Time now) {
  auto refused = std::ranges::find(search.refused, attempt.strategy, &Search::Refused::strategy);
  if (refused == search.refused.end()) refused = search.refused.insert(refused, {attempt.strategy});
  refused->begun = attempt.chosen;
  refused->again = later(now, pause_after(++refused->times));
  return refused->times;
}

// Has a process that it is asked of begun since then? One that begins processes would begin again for ever.
bool has_new_process(const Strategy& strategy, Time since, const Knowledge& knowledge) {
  return !begins_anew(strategy) &&
         std::ranges::any_of(strategy.adaptations, [&](const Adaptation& adaptation) {
           return knowledge.components[adaptation.component].node_seen > since;
         });
}

}  // namespace

std::optional<StrategyId> LastResorts::next(RuleId id) const {
  std::optional<StrategyId> next;
  for (const StrategyId strategy : knowledge_.rules[id].strategies) {
    const bool is_sooner =
        !next || knowledge_.rules[strategy].within < knowledge_.rules[*next].within;
    if (is_left(strategy) && is_sooner) next = strategy;
  }
  return next;
}

Time LastResorts::begins(RuleId id, StrategyId strategy) const {
  const RuleState& state = knowledge_.states[id];
  const Search& search = state.search;
  const auto refused = std::ranges::find(search.refused, strategy, &Search::Refused::strategy);
  if (refused != search.refused.end()) return refused->again;
  const Time within = later(state.failing_since, knowledge_.rules[strategy].within);
  if (!search.is_at_last_resort) return within;
  return strategy == next(id) ? search.last_resort_at : std::max(search.last_resort_at, within);
}

std::vector<StrategyId> LastResorts::due(RuleId id, Time now) const {
  const RuleState& state = knowledge_.states[id];
  std::vector<StrategyId> all;
  const bool is_there = state.phase != RulePhase::kQuiet && !is_false(state.detection.trigger);
  if (!is_there || !state.search.is_at_last_resort || state.last_resort) return all;
  std::ranges::copy_if(
      knowledge_.rules[id].strategies, std::back_inserter(all),
      [&](StrategyId strategy) { return is_left(strategy) && begins(id, strategy) <= now; });
  std::ranges::sort(all, {}, [&](StrategyId strategy) {
    const auto refused =
        std::ranges::find(state.search.refused, strategy, &Search::Refused::strategy);
    return std::pair(refused != state.search.refused.end(), knowledge_.rules[strategy].within);
  });
  return all;
}

bool LastResorts::is_left(StrategyId strategy) const {
  return knowledge_.rules[strategy].is_last_resort && !knowledge_.states.is_tried(strategy);
}

void LastResorts::turn_to(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  if (state.search.is_at_last_resort || !next(id)) return;
  state.search.is_at_last_resort = true;
  write_.events.tell(now, LastResortReached{id});
}

bool LastResorts::has_to_give_way(RuleId id, Time now) const {
  const RuleState& state = knowledge_.states[id];
  if (!state.last_resort || state.last_resort->stage == Attempt::Stage::kWaiting) return false;
  const Strategy& current = knowledge_.rules[state.last_resort->strategy];
  return std::ranges::any_of(knowledge_.rules[id].strategies, [&](StrategyId other) {
    const Duration within = knowledge_.rules[other].within;
    return is_left(other) && within > current.within &&
           std::ranges::find(state.search.refused, other, &Search::Refused::strategy) ==
               state.search.refused.end() &&
           now >= later(state.failing_since, within);
  });
}

void LastResorts::give_way(RuleId id, Time now) {
  CULPRIT_ASSERT(knowledge_.states[id].last_resort);
  const Attempt attempt = *knowledge_.states[id].last_resort;
  abandon(id, now);
  refuse(write_.states.state(id).search, attempt, now);
}

void LastResorts::abandon(RuleId id, Time now) {
  CULPRIT_ASSERT(knowledge_.states[id].last_resort);
  const Attempt attempt = *std::exchange(write_.states.state(id).last_resort, std::nullopt);
  write_.couplings.ended(attempt, now);
}

void LastResorts::judge(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  if (!state.last_resort) return;
  const bool has_effect = state.last_resort->stage == Attempt::Stage::kWaiting;
  if (!has_effect && state.last_resort->obstacle.empty()) return;
  const Attempt attempt = *state.last_resort;
  abandon(id, now);
  Search& search = state.search;
  if (!has_effect) {
    write_.events.tell(now, StrategyFailed{attempt.strategy, attempt.obstacle});
    if (attempt.has_no_failure) return;
    // One part failed; what the others changed stays.
    const bool has_parts = knowledge_.rules[attempt.strategy].adaptations.size() > 1;
    if (has_parts && attempt.first_change != kNever && state.phase != RulePhase::kQuiet)
      stand(state, attempt.strategy, now);
    if (refuse(search, attempt, now) < knowledge_.rules[id].policies.attempts) return;
  } else if (attempt.has_no_failure) {
    return write_.events.tell(now, OrderCarriedOut{attempt.strategy});
  } else {
    write_.fights.took_effect(attempt.strategy);
    write_.events.tell(now, LastResortDone{attempt.strategy});
    if (state.phase != RulePhase::kQuiet) stand(state, attempt.strategy, attempt.effective);
    const Duration impact =
        duration_of(knowledge_.rules[attempt.strategy].impact, knowledge_.rules);
    search.last_resort_at = later(attempt.effective, impact + knowledge_.signals.latency(id));
    std::erase_if(search.refused,
                  [&](const auto& each) { return each.strategy == attempt.strategy; });
  }
  write_.states.set_tried(attempt.strategy, true);
  if (const auto following = next(id))
    search.last_resort_at = std::max(
        search.last_resort_at, later(state.failing_since, knowledge_.rules[*following].within));
}

void LastResorts::watch(RuleId id, Time now) {
  RuleState& state = write_.states.state(id);
  if (state.phase == RulePhase::kQuiet) return;
  for (RuleState::Standing& each : state.standing) {
    const auto& parts = knowledge_.rules[each.strategy].adaptations;
    const bool begins_again = !each.is_lost && std::ranges::any_of(parts, [&](const Adaptation& a) {
      return is_lost(a, each.since, knowledge_.components[a.component]);
    });
    each.is_lost |= begins_again;
    if (begins_again) write_.states.set_tried(each.strategy, false);
  }
  for (const Search::Refused& each : state.search.refused) {
    if (has_new_process(knowledge_.rules[each.strategy], each.begun, knowledge_))
      write_.states.set_tried(each.strategy, false);
  }
  const auto following = next(id);
  if (following && !is_false(state.detection.trigger) &&
      now >= later(state.failing_since, knowledge_.rules[*following].within))
    turn_to(id, now);
}

std::optional<StrategyId> LastResorts::that_helped(RuleId id) const {
  const RuleState& state = knowledge_.states[id];
  if (state.standing.empty()) return std::nullopt;
  const RuleState::Standing& last = state.standing.back();
  const Time gone = state.detection.trigger_since;
  const Duration impact = duration_of(knowledge_.rules[last.strategy].impact, knowledge_.rules);
  const bool is_in_time =
      gone >= last.since && gone <= later(last.since, impact + knowledge_.signals.latency(id));
  return is_in_time ? std::optional(last.strategy) : std::nullopt;
}

Time LastResorts::next_time(RuleId id) const {
  Time earliest = kNever;
  if (knowledge_.states[id].phase == RulePhase::kQuiet) return earliest;
  for (const StrategyId strategy : knowledge_.rules[id].strategies) {
    if (is_left(strategy)) earliest = std::min(earliest, begins(id, strategy));
  }
  return earliest;
}

}  // namespace culprit
