#include "knowledge/latencies.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>

namespace culprit {
namespace {

using namespace std::chrono_literals;

// Evidence is not awaited for longer than this beyond the statement while that is unproven.
constexpr Duration kUnproven = 2s;

// From these log-odds on the statement counts as exceeded, or as kept. The latter needs less: a
// statement is believed by default, and later evidence corrects it.
constexpr double kExceeds = 3;
constexpr double kKeeps = 1.2;
// A rule whose learned lateness is within the statement, or beyond it, says so much.
constexpr double kIsWithin = -0.4;
constexpr double kIsBeyond = 2;

bool reads_value(const Input& input) {
  return input.subject() == Input::Subject::kSignal ||
         input.subject() == Input::Subject::kDiagnostic;
}

// The diagnostic status that carries the value; empty: another source.
std::string status_of(const Input& input, const RuleSet& rules) {
  if (input.kind == Input::Kind::kLevel) return rules.diagnostics[input.diagnostic.index].name;
  if (!reads_value(input)) return "";
  const auto* key = std::get_if<DiagnosticKey>(&rules[input.signal].source);
  return key != nullptr ? key->status : "";
}

// Does the rule only report on a value that another rule acts on? A second threshold is no second value.
bool only_reports_the_same(const Rule& rule, const Input& input, const RuleSet& rules) {
  return rule.strategies.empty() && std::ranges::any_of(input.readers, [&](RuleId reader) {
           return !rules[reader].strategies.empty();
         });
}

// The least impact that a `wanted` strategy has.
Duration least_impact(const Rule& rule, const RuleSet& rules, auto wanted) {
  std::optional<Cycles> least;
  for (const StrategyId id : rule.strategies) {
    if (wanted(rules[id]) && (!least || rules[id].impact < *least)) least = rules[id].impact;
  }
  return duration_of(least.value_or(Cycles{0}), rules);
}

// The impact of one that starts a process is mostly the time of that start.
bool starts_nothing(const Strategy& strategy) {
  return std::ranges::none_of(strategy.adaptations, launches);
}

}  // namespace

Latencies::Latencies(const RuleSet& rules)
    : is_late_(rules.rules.size(), false),
      stated_(rules.rules.size()),
      learned_(rules.rules.size()),
      suspected_(rules.rules.size()),
      cycle_(rules.cycle) {
  std::map<std::string, std::set<std::size_t>> readers;  // of each status: rules
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    for (const InputId id : rules.rules[r].inputs) {
      const std::string status = status_of(rules[id], rules);
      if (!status.empty() && !only_reports_the_same(rules.rules[r], rules[id], rules))
        readers[status].insert(r);
    }
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const auto& inputs = rules.rules[r].inputs;
    is_late_[r] = std::any_of(inputs.begin(), inputs.end(), [&](InputId id) {
      const std::string status = status_of(rules[id], rules);
      return reads_value(rules[id]) && (status.empty() || readers[status].size() < 2);
    });
    if (!is_late_[r]) continue;
    const Duration most = least_impact(rules.rules[r], rules, [](const Strategy&) { return true; });
    const Duration presumed = least_impact(rules.rules[r], rules, starts_nothing) - rules.cycle;
    stated_[r] = {Duration::zero(), most, std::clamp<Duration>(presumed, Duration::zero(), most)};
  }
}

// A sample is as long as a reading needs, too: less than a cycle in most robots.
Latencies::Range Latencies::lateness(RuleId rule) const {
  const Range& stated = stated_[rule.index];
  const Learned& learned = learned_[rule.index];
  if (learned.count > 0) {
    const Duration least = std::max<Duration>(Duration::zero(), learned.range.least - cycle_);
    return {least, std::max(learned.range.most, stated.most), least};
  }
  if (!is_late_[rule.index]) return {};
  if (statement_ == Statement::kExceeded)
    return {stated.least, std::max(stated.most + excess_, kSlowMonitor), stated.least};
  return {stated.least, stated.most + excess_, stated.presumed};
}

Duration Latencies::reckon_with(RuleId rule) const {
  const Duration most = lateness(rule).most;
  const bool is_unproven = statement_ == Statement::kUnproven && is_late(rule) && !is_learned(rule);
  return is_unproven ? std::max(most, kUnproven) : most;
}

Duration Latencies::patience(RuleId rule) const {
  const Suspected& suspected = suspected_[rule.index];
  const Duration most = lateness(rule).most;
  return suspected.is_refuted ? most : std::max(most, suspected.after);
}

void Latencies::suspect(RuleId rule, Duration after) {
  Suspected& suspected = suspected_[rule.index];
  if (is_late_[rule.index])
    suspected.after = std::min(std::max(after, suspected.after), kMostPatience);
}

void Latencies::stays(RuleId rule, Duration after) {
  Suspected& suspected = suspected_[rule.index];
  suspected.is_refuted |= suspected.after > lateness(rule).most && after >= suspected.after;
}

double Latencies::repairs() const {
  double sum = 0;
  for (std::size_t r = 0; r < learned_.size(); ++r) {
    if (learned_[r].count == 0) continue;
    const bool is_within = learned_[r].range.most <= stated_[r].most + 2 * cycle_;
    sum += is_within ? kIsWithin : kIsBeyond;
  }
  return std::clamp(sum, -kExceeds, kExceeds);
}

void Latencies::weigh(double spreading) {
  const double sum = repairs() + spreading;
  if (sum >= kExceeds) {
    statement_ = Statement::kExceeded;
  } else if (sum <= (statement_ == Statement::kExceeded ? -kExceeds : -kKeeps)) {
    statement_ = Statement::kKept;
  }
}

void Latencies::cleared(RuleId rule, Duration after) {
  after = std::clamp<Duration>(after, Duration::zero(), kMostPatience);
  Learned learned = learned_[rule.index];
  const bool is_first = learned.count == 0;
  const Duration least = is_first ? after : std::min(learned.range.least, after);
  const Duration most = is_first ? after : std::max(learned.range.most, after);
  set(rule, {std::min(learned.count, Learned::kMost - 1) + 1, {least, most, least}});
}

void Latencies::fired(RuleId rule, Duration after) {
  Learned learned = learned_[rule.index];
  if (learned.count == 0 || after <= learned.range.most) return;
  learned.range.most = std::min(after, kMostPatience);
  set(rule, learned);
}

void Latencies::set(RuleId rule, const Learned& learned) {
  if (!is_late_[rule.index]) return;
  learned_[rule.index] = learned;
  extend_excess(rule.index);
  weigh(0);
}

void Latencies::forget(RuleId rule) {
  learned_[rule.index] = {};
  suspected_[rule.index] = {};
  excess_ = Duration::zero();
  statement_ = Statement::kUnproven;
  for (std::size_t r = 0; r < learned_.size(); ++r) extend_excess(r);
  weigh(0);
}

void Latencies::extend_excess(std::size_t rule) {
  const Learned& learned = learned_[rule];
  if (learned.count > 0)
    excess_ = std::max(excess_, learned.range.most - stated_[rule].most - cycle_);
}

}  // namespace culprit
