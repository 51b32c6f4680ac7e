#include "knowledge/transients.h"

#include <algorithm>

namespace culprit {
namespace {

// So many of its own stand for a rule; so many, of so many rules, stand for all.
constexpr int kEnough = 3;
constexpr int kEnoughRules = 2;
// The share of all rules counts like so many failures of the rule.
constexpr double kOfAll = 2;

int sum(int a, int b) { return std::min(a, Transients::Seen::kMost - b) + b; }

Transients::Seen sum(const Transients::Seen& a, const Transients::Seen& b) {
  return {sum(a.cleared, b.cleared), sum(a.stayed, b.stayed), std::max(a.longest, b.longest)};
}

}  // namespace

void Transients::cleared(RuleId rule, Time detected, Time gone) {
  const Duration lasted = std::max<Duration>(gone - detected, Duration::zero());
  if (lasted <= kLongest) open_.push_back({rule, lasted, later(gone, lasted)});
}

void Transients::came_back(RuleId rule) {
  const bool was_open =
      std::erase_if(open_, [&](const Open& each) { return each.rule == rule; }) > 0;
  if (was_open) stayed(rule);
}

void Transients::stayed(RuleId rule) { add(rule, {0, 1, {}}); }

void Transients::advance(Time now) {
  std::erase_if(open_, [&](const Open& each) {
    if (now < each.due) return false;
    add(each.rule, {1, 0, each.lasted});
    return true;
  });
}

void Transients::add(RuleId rule, const Seen& seen) { set(rule, sum(seen_[rule.index], seen)); }

void Transients::forget(RuleId rule) {
  std::erase_if(open_, [&](const Open& each) { return each.rule == rule; });
  set(rule, {});
}

void Transients::set(RuleId rule, const Seen& seen) {
  seen_[rule.index] = seen;
  pooled_ = {};
  for (const Seen& each : seen_) pooled_ = sum(pooled_, each);
  const auto rules =
      std::ranges::count_if(seen_, [](const Seen& each) { return each.cleared > 0; });
  if (pooled_.cleared < kEnough || rules < kEnoughRules) pooled_ = {0, pooled_.stayed, {}};
}

double Transients::share(RuleId rule) const {
  const Seen& own = seen_[rule.index];
  const double of_all = pooled_.cleared / (1.0 + pooled_.cleared + pooled_.stayed);
  return (own.cleared + kOfAll * of_all) / (kOfAll + own.cleared + own.stayed);
}

const Transients::Seen& Transients::basis(RuleId rule) const {
  const bool counts_alone = seen_[rule.index].cleared >= kEnough || pooled_.cleared == 0;
  return counts_alone ? seen_[rule.index] : pooled_;
}

Duration Transients::longest(RuleId rule) const { return basis(rule).longest; }

Duration Transients::patience(RuleId rule) const {
  const Seen& seen = basis(rule);
  if (seen.cleared == 0) return {};
  return std::min<Duration>(seen.longest + 2 * seen.longest / seen.cleared, kLongest);
}

}  // namespace culprit
