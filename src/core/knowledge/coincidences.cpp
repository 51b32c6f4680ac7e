#include "knowledge/coincidences.h"

#include <algorithm>

namespace culprit {
namespace {

void count_up(int& count) { count = std::min(count, Coincidences::kMost - 1) + 1; }

}  // namespace

void Coincidences::began(RuleId rule, std::span<const RuleId> others) {
  count_up(began_[rule.index]);
  if (others.size() > kMostTogether) return;
  for (const RuleId other : others) count_up(together_[ordered(rule, other)]);
}

int Coincidences::together(RuleId a, RuleId b) const {
  const auto found = together_.find(ordered(a, b));
  return found == together_.end() ? 0 : found->second;
}

bool Coincidences::coincide(RuleId a, RuleId b) const {
  const int both = together(a, b);
  return both >= kLeast && both >= kShare * std::min(began_[a.index], began_[b.index]);
}

std::vector<RuleId> Coincidences::of(RuleId rule) const {
  std::vector<RuleId> all;
  for (const auto& [pair, count] : together_) {
    const bool has_it = pair.first == rule || pair.second == rule;
    if (!has_it || !coincide(pair.first, pair.second)) continue;
    all.push_back(pair.first == rule ? pair.second : pair.first);
  }
  std::sort(all.begin(), all.end());
  return all;
}

void Coincidences::set(RuleId a, RuleId b, int count) {
  (a == b ? began_[a.index] : together_[ordered(a, b)]) = count;
}

void Coincidences::forget(RuleId rule) {
  began_[rule.index] = 0;
  for (auto& [pair, count] : together_) {
    if (pair.first == rule || pair.second == rule) count = 0;
  }
}

}  // namespace culprit
