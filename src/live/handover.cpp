#include "live/handover.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "journal/requests.h"

namespace culprit::live {
namespace {

// The same component or rule of other rules; nothing: they do not have it.
std::optional<Silenceable> translated(const Silenceable& what, const RuleSet& from,
                                      const RuleSet& to) {
  if (const auto* rule = std::get_if<RuleId>(&what)) {
    const auto found = journal::find_rule(to, from[*rule].name);
    return found ? std::optional<Silenceable>(*found) : std::nullopt;
  }
  const auto found = journal::find_component(to, from[std::get<ComponentId>(what)].name);
  return found ? std::optional<Silenceable>(*found) : std::nullopt;
}

void add_what_stays_down(const Knowledge& knowledge, const RuleSet& next, History& past) {
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const auto departure = knowledge.departures.of(ComponentId(c), knowledge.now);
    const auto same = journal::find_component(next, knowledge.rules.components[c].name);
    if (departure && departure->what == Departures::What::kStaysDown && same)
      past.push_back({knowledge.now, StaysDown{{*same}, departure->why, departure->launcher}});
  }
}

}  // namespace

journal::Learned learned_by(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  journal::Learned learned;
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    const Strategy& strategy = rules.strategies[s];
    learned.beliefs.push_back({rules[strategy.rule].name, strategy.name,
                               knowledge.beliefs[StrategyId(s)],
                               knowledge.beliefs.prior(StrategyId(s))});
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    for (const Couplings::Learned& each : knowledge.couplings.of(RuleId(r)))
      learned.couplings.push_back({rules[each.cause].name, rules.rules[r].name, each.coupling});
    const Latencies::Learned& latency = knowledge.latencies.learned(RuleId(r));
    if (latency.count > 0)
      learned.latencies.push_back(journal::named(rules.rules[r].name, latency));
    const Transients::Seen& seen = knowledge.transients.seen(RuleId(r));
    if (seen == Transients::Seen()) continue;
    for (journal::LearnedLatency& each : journal::named(rules.rules[r].name, seen))
      learned.latencies.push_back(std::move(each));
  }
  learned.coincidences = journal::named(knowledge.coincidences, Coincidences(rules), rules);
  return learned;
}

History waiting_verdicts(const Knowledge& knowledge, const RuleSet& next, Time first) {
  const RuleSet& rules = knowledge.rules;
  History waiting;
  for (const PendingOutcome& outcome : knowledge.outcomes.open) {
    const Strategy& strategy = rules[outcome.strategy];
    const auto same = journal::find_strategy(next, rules[strategy.rule].name, strategy.name);
    if (!same || outcome.is_void) continue;
    waiting.push_back({outcome.judged, OutcomePending{*same, outcome.has_helped && !outcome.is_back,
                                                      std::max(outcome.due, first)}});
  }
  add_what_stays_down(knowledge, next, waiting);
  return waiting;
}

std::vector<Observation> standing_orders(const Manager& manager, bool advised_at_first,
                                         const RuleSet& next, Time now) {
  std::vector<Observation> orders;
  const auto add = [&](Order order) { orders.push_back({now, std::move(order)}); };
  const bool advises = manager.autonomy() == Autonomy::kAdvise;
  if (advises != advised_at_first)
    add({0, "before the reload", "it was ordered so", SetDryRun{advises}});
  if (manager.governor().is_paused()) add({0, "before the reload", "it was paused", Pause{}});
  for (const Governor::ActiveSilence& each : manager.governor().silences()) {
    const auto what = translated(each.what, manager.knowledge().rules, next);
    if (!what || each.until <= now) continue;
    Silence silence{*what, {}};
    if (each.until != kNever) silence.lasts = each.until - now;
    add({0, each.author, each.reason, silence});
  }
  return orders;
}

}  // namespace culprit::live
