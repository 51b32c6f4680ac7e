#include "knowledge/coincidences.h"

#include <algorithm>
#include <iterator>

namespace culprit {
namespace {

void count_up(int& count) { count = std::min(count, Coincidences::kMost - 1) + 1; }

}  // namespace

int& Coincidences::count_of(RuleId a, RuleId b) {
  const auto [place, is_new] = together_.try_emplace(ordered(a, b), 0);
  const auto add = [&](RuleId partner, RuleId to) {
    std::vector<RuleId>& all = rules_[to.index].partners;
    all.insert(std::ranges::lower_bound(all, partner), partner);
  };
  if (is_new) {
    add(a, b);
    add(b, a);
  }
  return place->second;
}

void Coincidences::began(RuleId rule, std::span<const RuleId> others) {
  ++rules_[rule.index].changes;
  count_up(rules_[rule.index].began);
  if (others.size() > kMostTogether) return;
  for (const RuleId other : others) count_up(count_of(rule, other));
}

int Coincidences::together(RuleId a, RuleId b) const {
  const auto found = together_.find(ordered(a, b));
  return found == together_.end() ? 0 : found->second;
}

bool Coincidences::coincide(RuleId a, RuleId b) const {
  const int both = together(a, b);
  return both >= kLeast && both >= kShare * std::min(times(a), times(b));
}

std::vector<RuleId> Coincidences::of(RuleId rule) const {
  std::vector<RuleId> all;
  std::ranges::copy_if(partners(rule), std::back_inserter(all),
                       [&](RuleId partner) { return coincide(rule, partner); });
  return all;
}

void Coincidences::set(RuleId a, RuleId b, int count) {
  ++rules_[a.index].changes;
  (a == b ? rules_[a.index].began : count_of(a, b)) = count;
}

void Coincidences::forget(RuleId rule) {
  ++rules_[rule.index].changes;
  rules_[rule.index].began = 0;
  for (const RuleId partner : partners(rule)) together_[ordered(rule, partner)] = 0;
}

}  // namespace culprit
