#include "drill/results.h"

#include <algorithm>
#include <cmath>

#include "journal/json.h"

namespace culprit::drill {
namespace {

std::vector<StrategyResult> strategies_in(const RuleSet& rules) {
  std::vector<StrategyResult> all;
  for (const Rule& rule : rules.rules) {
    for (const StrategyId s : rule.strategies)
      all.push_back({rule.name,
                     rules[s].name,
                     0,
                     0,
                     {},
                     100 * rules[s].success.value,
                     rules[s].confidence,
                     rules[s].impact.count});
  }
  return all;
}

// The robot was well again by itself before any rule could have noticed.
bool is_harmless(const FaultResult& result) {
  constexpr double kAtOnce = 1;  // s
  return result.fault.starts_with(word_of(FaultKind::kRestart)) && result.well == result.times &&
         *std::ranges::max_element(result.well_after) < kAtOnce;
}

std::string first_wrong_choice(const Trial& trial, const Finding& finding) {
  for (const Json& event : trial.events) {
    if (journal::text_of(event, "type") != "strategy_chosen") continue;
    for (const Json& each : event.value("components", Json::array())) {
      if (each.is_string() && finding.wrongly.contains(each.get<std::string>()))
        return trial.id() + ": " + journal::text_of(event, "text");
    }
  }
  return trial.id();
}

void add(const Trial& trial, const Finding& finding, FaultResult& out) {
  ++out.times;
  if (finding.noticed_after) {
    ++out.noticed;
    ++out.first_rule[finding.rule];
    out.noticed_after.push_back(*finding.noticed_after);
  }
  if (!finding.wrongly.empty()) {
    ++out.blamed_wrongly;
    out.evidence.push_back(first_wrong_choice(trial, finding));
  } else if (!finding.blamed.empty()) {
    ++out.blamed_rightly;
  }
  for (const std::string& each : finding.helped) ++out.helped[each];
  for (const std::string& each : finding.silent) ++out.silent[each];
  if (!finding.well_after) return;
  ++out.well;
  out.well_after.push_back(*finding.well_after);
  if (!trial.undone) ++out.healed;
}

}  // namespace

Interval interval_of(int successes, int tries) {
  if (tries <= 0) return {};
  constexpr double kZ = 1.959964;  // of 95 %
  const double n = tries;
  const double share = successes / n;
  const double middle = (share + kZ * kZ / (2 * n)) / (1 + kZ * kZ / n);
  const double half =
      kZ * std::sqrt(share * (1 - share) / n + kZ * kZ / (4 * n * n)) / (1 + kZ * kZ / n);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

Spread spread_of(std::vector<double> numbers) {
  if (numbers.empty()) return {};
  std::ranges::sort(numbers);
  const std::size_t middle = numbers.size() / 2;
  const double median =
      numbers.size() % 2 == 1 ? numbers[middle] : (numbers[middle - 1] + numbers[middle]) / 2;
  return {median, numbers.back(), numbers.size()};
}

std::chrono::seconds ready_of(const std::vector<double>& starts) {
  return std::chrono::seconds(
      static_cast<std::int64_t>(std::ceil(*std::ranges::max_element(starts))));
}

std::int64_t impact_of(const std::vector<double>& effects, Duration cycle) {
  // The next one may be later than all of a few.
  const double most = *std::ranges::max_element(effects);
  return 1 + std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(most / seconds(cycle))));
}

Results results_of(const std::vector<Trial>& trials, const RuleSet& rules, const Paths& paths,
                   const std::string& date) {
  Results out;
  out.robot = rules.robot;
  out.date = date;
  out.cycle = rules.cycle;
  out.strategies = strategies_in(rules);
  for (const Component& each : rules.components)
    if (each.ready > Duration::zero()) out.ready.emplace(each.name, each.ready);
  std::map<std::string, FaultResult> faults;
  std::set<std::string> names;
  for (const Rule& rule : rules.rules) names.insert(rule.name);
  std::set<std::string> fired;
  for (const Trial& trial : trials) {
    if (!trial.trouble.empty()) {
      out.spoilt.push_back(trial.id() + ": " + trial.trouble);
      continue;
    }
    const Finding finding = finding_of(trial, names);
    add(trial, finding, faults[to_string(trial.faults)]);
    fired.insert(finding.fired.begin(), finding.fired.end());
    for (const std::string& component : finding.wrongly) ++out.touched[component];
    for (const Attempted& each : attempts_in(trial)) {
      const auto known = std::ranges::find_if(out.strategies, [&](const StrategyResult& s) {
        return s.rule == each.rule && s.strategy == each.strategy;
      });
      if (known == out.strategies.end()) continue;
      ++known->tried;
      if (each.succeeded) ++known->helped;
      if (each.succeeded && each.effect) known->effects.push_back(*each.effect);
    }
  }
  for (auto& [name, result] : faults) {
    result.fault = name;
    if (result.noticed == 0 && !is_harmless(result)) out.unnoticed.push_back(name);
    out.faults.push_back(std::move(result));
  }
  for (const Rule& rule : rules.rules) {
    if (!fired.contains(rule.name)) out.untripped.push_back(rule.name);
  }
  for (const StrategyResult& each : out.strategies) {
    if (each.tried > 0 && each.helped == 0)
      out.never_helped.push_back(each.rule + "." + each.strategy);
  }
  out.hidden = hidden_dependencies(trials, paths);
  return out;
}

}  // namespace culprit::drill
