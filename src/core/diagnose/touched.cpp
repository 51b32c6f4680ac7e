#include "diagnose/touched.h"

#include <algorithm>
#include <iterator>

#include "base/sort_unique.h"
#include "diagnose/blameless.h"
#include "diagnose/senders.h"

namespace culprit::diagnose {
namespace {

bool mends(const Adaptation& a) {
  return a.type == AdaptationType::kRestart || a.type == AdaptationType::kCall || launches(a);
}

// Those that alone send what the rule reads.
std::vector<ComponentId> publishers_read(const Rule& rule, const Knowledge& knowledge) {
  std::vector<ComponentId> all;
  for (const InputId id : rule.inputs) {
    if (const auto sender = sender_of(knowledge.rules[id], knowledge)) all.push_back(*sender);
  }
  sort_unique(all);
  return all;
}

// Those of `touched` that publish what the rule reads and that one of its strategies mends.
std::vector<ComponentId> mended_publishers(const Rule& rule,
                                           const std::vector<ComponentId>& touched,
                                           const Knowledge& knowledge) {
  std::vector<ComponentId> all = publishers_read(rule, knowledge);
  std::erase_if(all, [&](ComponentId c) {
    return !std::ranges::binary_search(touched, c) ||
           std::ranges::none_of(rule.strategies, [&](StrategyId id) {
             return std::ranges::any_of(knowledge.rules[id].adaptations, [&](const Adaptation& a) {
               return a.component == c && (a.type == AdaptationType::kRestart || launches(a));
             });
           });
  });
  return all;
}

}  // namespace

bool mends(const Strategy& strategy) {
  return std::ranges::any_of(strategy.adaptations, [](const Adaptation& a) { return mends(a); });
}

std::vector<ComponentId> mended_by(RuleId rule, const RuleSet& rules) {
  std::vector<ComponentId> all;
  for (const StrategyId id : rules[rule].strategies) {
    if (rules[id].is_last_resort) continue;
    for (const Adaptation& a : rules[id].adaptations) {
      if (mends(a)) all.push_back(a.component);
    }
  }
  sort_unique(all);
  return all;
}

bool is_mended(RuleId rule, const RuleSet& rules) {
  return std::ranges::any_of(rules[rule].strategies, [&](StrategyId id) {
    return !rules[id].is_last_resort && mends(rules[id]);
  });
}

std::vector<ComponentId> touched_by(RuleId rule, const Knowledge& knowledge) {
  const Rule& of = knowledge.rules[rule];
  if (of.repaired.size() == 1) return of.repaired;
  if (of.components.empty()) return publishers_read(of, knowledge);
  if (of.repaired.empty()) return of.components;
  std::vector<ComponentId> all = mended_publishers(of, of.repaired, knowledge);
  if (all.empty()) all = of.repaired;
  std::vector<ComponentId> to_blame = all;
  std::erase_if(to_blame, [&](ComponentId c) { return is_blameless(c, rule, knowledge); });
  return to_blame.empty() ? all : to_blame;
}

std::vector<ComponentId> watched_beside(RuleId rule, const Knowledge& knowledge) {
  const Rule& of = knowledge.rules[rule];
  if (!is_mended(rule, knowledge.rules)) return {};
  std::vector<ComponentId> read = publishers_read(of, knowledge);
  const std::vector<ComponentId> touched = touched_by(rule, knowledge);
  const bool is_any_touched = std::ranges::any_of(
      read, [&](ComponentId c) { return std::ranges::binary_search(touched, c); });
  if (is_any_touched) read.clear();
  return read;
}

std::vector<ComponentId> downstream_of_causes(RuleId rule, const Knowledge& knowledge) {
  std::vector<ComponentId> all = touched_by(rule, knowledge);
  std::ranges::copy(watched_beside(rule, knowledge), std::back_inserter(all));
  return all;
}

std::vector<ComponentId> spreads_from(RuleId rule, const Knowledge& knowledge) {
  std::vector<ComponentId> all = touched_by(rule, knowledge);
  if (symptom_of(rule, knowledge) == Symptom::kOutage) return all;
  const std::vector<ComponentId> read = watched_beside(rule, knowledge);
  all.insert(all.end(), read.begin(), read.end());
  sort_unique(all);
  return all;
}

}  // namespace culprit::diagnose
