#include "analyze/left_off.h"

#include "analyze/backoff.h"
#include "knowledge/ambiguity.h"

namespace culprit {

void forget_tried(const Rule& rule, const RuleSet& rules, Search& search) {
  for (std::size_t place = 0; place < rule.strategies.size(); ++place) {
    if (!rules[rule.strategies[place]].is_last_resort) search.tried[place] = false;
  }
}

void LeftOffSearches::remember(const Event& event) {
  const auto left_off = [&](RuleId id) -> std::optional<LeftOff>& {
    return states_.state(id).left_off;
  };
  if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    remember_detected(detected->rule, event.at);
  } else if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
    if (resolved->strategy) remember_tried(*resolved->strategy);
    remember_gone(resolved->rule, event.at, knowledge_.rules[resolved->rule].policies.cooldown);
  } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
    remember_gone(lost->rule, event.at, Duration::zero());
  } else if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
    remember_tried(failed->strategy);
  } else if (const auto* spent = std::get_if<RoundSpent>(&event.what)) {
    if (auto& left = left_off(spent->rule)) {
      forget_tried(knowledge_.rules[spent->rule], knowledge_.rules, left->search);
      left->search.retry_at = later(event.at, pause_after(++left->search.round));
    }
  } else if (const auto* last = std::get_if<LastResortReached>(&event.what)) {
    if (auto& left = left_off(last->rule)) left->search.is_at_last_resort = true;
  } else if (const auto* taken = std::get_if<LastResortDone>(&event.what)) {
    // One that ends or starts nothing is begun anew by each process: that harms nothing.
    const Strategy& last_resort = knowledge_.rules[taken->strategy];
    if (auto& left = left_off(last_resort.rule); left && begins_anew(last_resort))
      left->search.tried[knowledge_.states.place_of(taken->strategy)] = true;
  } else if (const auto* exhausted = std::get_if<RuleExhausted>(&event.what)) {
    if (auto& left = left_off(exhausted->rule)) left->search.is_exhausted = true;
  }
}

void LeftOffSearches::remember_tried(StrategyId strategy) {
  const Strategy& tried = knowledge_.rules[strategy];
  auto& left = states_.state(tried.rule).left_off;
  if (!left || tried.is_last_resort) return;
  ++left->search.attempts;
  const std::size_t place = knowledge_.states.place_of(strategy);
  left->search.tried[place] = left->search.ever_tried[place] = true;
}

void LeftOffSearches::remember_detected(RuleId id, Time at) {
  auto& left = states_.state(id).left_off;
  if (left && left->gone && is_proven(*left->gone, at)) left.reset();
  if (left) {
    // Without having gone it is what a process that took the search over detected anew.
    if (left->gone) ++left->search.times;
    left->gone.reset();
    return;
  }
  left.emplace().since = at;
  left->search = Search(knowledge_.rules[id].strategies.size());
  left->search.times = 1;
}

void LeftOffSearches::remember_gone(RuleId id, Time at, Duration quiet) {
  RuleState& state = states_.state(id);
  if (state.left_off) state.left_off->gone = at;
  state.quiet_until = later(at, quiet);
}

void LeftOffSearches::detected(RuleId id, Time now) {
  auto& left = states_.state(id).left_off;
  if (!left || !left->gone) return;
  if (is_proven(*left->gone, now)) {
    left.reset();
  } else {
    ++left->search.times;
  }
}

bool LeftOffSearches::is_proven(Time gone, Time now) const {
  return later(gone, knowledge_.outcomes.healthy) <= now;
}

}  // namespace culprit
