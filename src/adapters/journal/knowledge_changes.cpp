#include "journal/knowledge_changes.h"

#include <utility>

namespace culprit::journal {

KnowledgeChanges::KnowledgeChanges(const Knowledge& knowledge)
    : knowledge_(knowledge), coincidences_(knowledge.coincidences) {
  for (std::size_t s = 0; s < knowledge.rules.strategies.size(); ++s)
    beliefs_.push_back(knowledge.beliefs[StrategyId(s)]);
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const auto all = knowledge.couplings.of(RuleId(r));
    couplings_.emplace_back(all.begin(), all.end());
    latencies_.push_back(knowledge.latencies.learned(RuleId(r)));
    transients_.push_back(knowledge.transients.seen(RuleId(r)));
    coincidences_seen_.push_back(knowledge.coincidences.changes(RuleId(r)));
  }
}

Learned KnowledgeChanges::learned() {
  const RuleSet& rules = knowledge_.rules;
  Learned learned;
  for (std::size_t s = 0; s < beliefs_.size(); ++s) {
    const Belief& belief = knowledge_.beliefs[StrategyId(s)];
    if (belief == beliefs_[s]) continue;
    beliefs_[s] = belief;
    const Strategy& strategy = rules.strategies[s];
    learned.beliefs.push_back({rules[strategy.rule].name, strategy.name, belief,
                               knowledge_.beliefs.prior(StrategyId(s))});
  }
  for (std::size_t r = 0; r < couplings_.size(); ++r) {
    const auto all = knowledge_.couplings.of(RuleId(r));
    // Both are in the order of their causes, of which a rule may have a thousand.
    auto old = couplings_[r].cbegin();
    for (const Couplings::Learned& each : all) {
      while (old != couplings_[r].cend() && old->cause < each.cause) ++old;
      const bool is_known = old != couplings_[r].cend() && old->cause == each.cause;
      if (is_known && old->coupling == each.coupling) continue;
      learned.couplings.push_back({rules[each.cause].name, rules.rules[r].name, each.coupling});
    }
    couplings_[r].assign(all.begin(), all.end());
  }
  for (std::size_t r = 0; r < latencies_.size(); ++r) {
    const Latencies::Learned& latency = knowledge_.latencies.learned(RuleId(r));
    if (latency == latencies_[r]) continue;
    latencies_[r] = latency;
    learned.latencies.push_back(named(rules.rules[r].name, latency));
  }
  for (std::size_t r = 0; r < transients_.size(); ++r) {
    const Transients::Seen& seen = knowledge_.transients.seen(RuleId(r));
    if (seen == transients_[r]) continue;
    transients_[r] = seen;
    for (LearnedLatency& each : named(rules.rules[r].name, seen))
      learned.latencies.push_back(std::move(each));
  }
  for (std::size_t r = 0; r < coincidences_seen_.size(); ++r) {
    const std::uint64_t changes = knowledge_.coincidences.changes(RuleId(r));
    if (std::exchange(coincidences_seen_[r], changes) != changes)
      note_coincidences_of(RuleId(r), learned.coincidences);
  }
  return learned;
}

void KnowledgeChanges::note_coincidences_of(RuleId rule, std::vector<LearnedCoincidence>& changed) {
  const auto count_of = [&](const Coincidences& all, RuleId other) {
    return other == rule ? all.times(rule) : all.together(rule, other);
  };
  const auto note = [&](RuleId other) {
    const int count = count_of(knowledge_.coincidences, other);
    if (count == count_of(coincidences_, other)) return;
    coincidences_.set(rule, other, count);
    changed.push_back(
        coincidence_of(knowledge_.rules[rule].name, knowledge_.rules[other].name, count));
  };
  note(rule);
  for (const RuleId partner : knowledge_.coincidences.partners(rule)) note(partner);
}

std::optional<KnownRobot> KnowledgeChanges::robot(Time now) {
  const std::uint64_t discovered = knowledge_.discovered.count();
  const std::uint64_t changes =
      knowledge_.graph.changes() + discovered + knowledge_.discovered.received_count();
  const bool is_old = robot_written_ != kLongAgo && later(robot_written_, kRobotAtLatest) <= now;
  const bool was_looked_at =
      robot_looked_at_ != kLongAgo && now < later(robot_looked_at_, kRobotPeriod);
  // A first discovery is written at once: if the node died together with culprit, the journal would
  // otherwise lack it. They are rare; topics' publishers come and go all the time.
  const bool is_first_sight = discovered != robot_discovered_;
  if ((changes == robot_changes_ && !is_old) || (was_looked_at && !is_first_sight))
    return std::nullopt;
  robot_changes_ = changes;
  robot_discovered_ = discovered;
  robot_looked_at_ = now;
  KnownRobot known = knowledge_.known_robot();
  if (known == robot_ && !is_old) return std::nullopt;
  robot_written_ = now;
  robot_ = known;
  return known;
}

}  // namespace culprit::journal
