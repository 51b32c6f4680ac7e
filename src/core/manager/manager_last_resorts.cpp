// How the manager begins last resorts: beside what is under way, and before what would change the same.
#include <algorithm>
#include <functional>
#include <iterator>

#include "analyze/backoff.h"
#include "knowledge/held.h"
#include "knowledge/undoes.h"
#include "manager/manager.h"
#include "plan/also_ended.h"
#include "plan/validity.h"

namespace culprit {
namespace {

bool touch_one_thing(const Strategy& last_resort, const Strategy& other) {
  const auto& adapted = other.components;
  return std::ranges::any_of(last_resort.adaptations, [&](const Adaptation& a) {
    const bool is_shared = std::binary_search(adapted.begin(), adapted.end(), a.component);
    const bool only_sets = syntax::names_parameter(a.type) || a.type == AdaptationType::kCall ||
                           a.type == AdaptationType::kChangeMode;
    return is_shared && !only_sets;
  });
}

bool would_change(const Strategy& other, const Strategy& last_resort, const Knowledge& knowledge) {
  return std::ranges::any_of(other.adaptations, [&](const Adaptation& change) {
    return std::ranges::any_of(last_resort.adaptations, [&](const Adaptation& held) {
      return changes(change, held, knowledge);
    });
  });
}

}  // namespace

void Manager::begin_last_resorts(Time now) {
  std::vector<RuleId> rules;
  for (const auto* list : {&knowledge_.states.active(), &knowledge_.states.exhausted()}) {
    std::ranges::copy_if(*list, std::back_inserter(rules),
                         [&](RuleId id) { return analyzer_.last_resorts().next(id).has_value(); });
  }
  // The most critical one comes first: it holds what the others then leave alone.
  std::ranges::stable_sort(rules, std::greater{},
                           [&](RuleId id) { return knowledge_.rules[id].policies.criticality; });
  for (const RuleId id : rules) {
    const StrategyId next = *analyzer_.last_resorts().next(id);
    const RuleState& state = knowledge_.states[id];
    const Time limit = later(state.failing_since, knowledge_.rules[next].within);
    const bool goes_away = state.detection.trigger.known && !state.detection.trigger.b;
    if (!goes_away && (now >= limit || !is_help_possible(id, limit, now)))
      analyzer_.last_resorts().turn_to(id, now);
    if (analyzer_.last_resorts().has_to_give_way(id, now)) {
      knowledge_.events.tell(
          now, StrategyAbandoned{state.last_resort->strategy, "the next last resort is due"});
      analyzer_.last_resorts().give_way(id, now);
    }
    for (const StrategyId due : analyzer_.last_resorts().due(id, now)) {
      if (begin_last_resort(due, now)) break;
    }
  }
}

// A person's pause holds it, and a robot that cannot do it: then it is tried again in each cycle.
bool Manager::begin_last_resort(StrategyId strategy, Time now) {
  const RuleId rule = knowledge_.rules[strategy].rule;
  const bool is_dry = autonomy_ == Autonomy::kAdvise;
  if (is_dry && knowledge_.states[rule].is_last_resort_advised) return true;
  refresh_conditions(strategy, now);
  plan::LastResortParts parts = plan::parts_of_last_resort(knowledge_.rules[strategy], knowledge_);
  std::optional<std::string> obstacle;
  if (!parts.obstacle.empty()) obstacle = std::move(parts.obstacle);
  if (governor_.holds_last_resort_back(strategy, std::move(obstacle), now)) {
    next_plan_ = std::min(next_plan_, later(now, knowledge_.rules.cycle));
    return false;
  }
  if (!is_dry) go_before_others(strategy, now);
  Candidate itself;
  itself.strategy = strategy;
  knowledge_.events.tell(now,
                         StrategyChosen{strategy,
                                        {itself},
                                        {},
                                        is_dry,
                                        {},
                                        plan::also_ended(knowledge_.rules[strategy], knowledge_)});
  if (is_dry) {
    knowledge_.states.advise_last_resort(rule);
  } else {
    begin(strategy, now, std::move(parts.obstacles));
  }
  return true;
}

// Abandons the strategies that would change the same thing, less critical last resorts among them; all
// others go on beside it.
void Manager::go_before_others(StrategyId strategy, Time now) {
  const Strategy& last_resort = knowledge_.rules[strategy];
  const std::vector<RuleId> active = knowledge_.states.active();
  for (const RuleId id : active) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (!attempt) continue;
    // Since it was done first, its own rule respects it (holder_against), and would begin the same again.
    if (knowledge_.states[id].stands(strategy)) continue;
    const Strategy& other = knowledge_.rules[attempt->strategy];
    if (!undoes(last_resort, other) && !touch_one_thing(last_resort, other)) continue;
    knowledge_.events.tell(
        now, StrategyAbandoned{attempt->strategy,
                               "the last resort " + last_resort.name + " goes first"});
    analyzer_.yield_to_last_resort(id, now);
  }
  const Criticality level = knowledge_.rules[last_resort.rule].policies.criticality;
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const auto& attempt = knowledge_.states[RuleId(r)].last_resort;
    if (!attempt || knowledge_.rules.rules[r].policies.criticality >= level) continue;
    if (!would_change(knowledge_.rules[attempt->strategy], last_resort, knowledge_)) continue;
    knowledge_.events.tell(
        now, StrategyAbandoned{attempt->strategy,
                               "the last resort " + last_resort.name + " goes first"});
    analyzer_.last_resorts().give_way(RuleId(r), now);
  }
}

bool Manager::is_beside_last_resort(StrategyId strategy) const {
  return std::ranges::any_of(knowledge_.rules[strategy].components, [&](ComponentId component) {
    const Attempt* holder = knowledge_.states.reservation(component);
    return holder != nullptr && knowledge_.rules[holder->strategy].is_last_resort;
  });
}

// Can another strategy of the rule have helped by then? By its impact: it may help at once.
bool Manager::is_help_possible(RuleId rule, Time limit, Time now) const {
  const RuleState& state = knowledge_.states[rule];
  const auto is_in_time = [&](StrategyId strategy, Time begun) {
    const Duration impact = duration_of(knowledge_.rules[strategy].impact, knowledge_.rules);
    return later(begun, impact) <= limit;
  };
  if (state.phase == RulePhase::kExhausted) return false;
  if (state.attempt && state.attempt->stage == Attempt::Stage::kAdapting)
    return is_in_time(state.attempt->strategy, now);
  if (state.attempt && state.attempt->stage == Attempt::Stage::kWaiting)
    return is_in_time(state.attempt->strategy, state.attempt->effective);
  Time from = std::max(now, state.search.retry_at);
  if (const auto held = governor_.restraint_on_all(now)) from = std::max(from, held->until);
  const auto& strategies = knowledge_.rules[rule].strategies;
  return std::ranges::any_of(strategies, [&](StrategyId strategy) {
    const Knowledge::Withheld& withheld = knowledge_.withheld[strategy.index];
    Time begun = withheld.reason.empty() ? from : std::max(from, withheld.until);
    if (knowledge_.states.is_tried(strategy))
      begun = later(begun, pause_after(state.search.round + 1));
    return is_in_time(strategy, begun) && !plan::invalidity(knowledge_.rules[strategy], knowledge_);
  });
}

}  // namespace culprit
