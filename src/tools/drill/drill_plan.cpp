#include "drill/drill_plan.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "base/amount.h"
#include "base/closest.h"
#include "base/duration_words.h"

namespace culprit::drill {
namespace {

// How often the rules let a component be broken in one drill.
std::int64_t limit_of(const std::string& component, const RuleSet& rules) {
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (const DrillLine& line : rules.drills) {
    if (line.what == DrillLine::What::kLimit && rules[line.component].name == component)
      least = std::min(least, line.times);
  }
  return least;
}

// Why a component must not be broken. Empty: it may.
std::string why_spared(ComponentId id, const RuleSet& rules, const PlanOptions& options) {
  const Component& component = rules[id];
  if (limit_of(component.name, rules) == 0)
    return "the rules say DRILL " + component.name + " limit 0";
  if (!component.host().empty()) return "it runs on another computer";
  if (component.composed) return "it shares a process with the other nodes of its container";
  if (!component.can_start_again()) return "no owner can start it again (LAUNCH, UNIT, CONTAINER)";
  const auto spared = options.spared.find(component.name);
  return spared == options.spared.end() ? "" : spared->second;
}

bool is_excluded(FaultKind kind, const std::string& component, const RuleSet& rules) {
  return std::ranges::any_of(rules.drills, [&](const DrillLine& line) {
    return line.what == DrillLine::What::kWithout && line.subject == word_of(kind) &&
           rules[line.component].name == component;
  });
}

bool is_wanted(FaultKind kind, const std::string& component, const RuleSet& rules,
               const PlanOptions& options) {
  const bool is_chosen = options.kinds.empty()
                             ? kind != FaultKind::kLoss
                             : std::ranges::find(options.kinds, kind) != options.kinds.end();
  return is_chosen && !is_excluded(kind, component, rules);
}

// Two components that the rules let be killed.
std::vector<std::vector<Fault>> pairs_of(std::vector<std::string> breakable, const RuleSet& rules) {
  std::erase_if(breakable, [&](const std::string& component) {
    return is_excluded(FaultKind::kKill, component, rules);
  });
  std::vector<std::vector<Fault>> pairs;
  for (std::size_t a = 0; a < breakable.size(); ++a) {
    for (std::size_t b = a + 1; b < breakable.size(); ++b)
      pairs.push_back(
          {Fault{FaultKind::kKill, breakable[a]}, Fault{FaultKind::kKill, breakable[b]}});
  }
  return pairs;
}

// std::shuffle differs between standard libraries.
template <class Item>
void shuffle(std::vector<Item>& items, std::mt19937_64& random) {
  for (std::size_t left = items.size(); left > 1; --left)
    std::swap(items[left - 1], items[random() % left]);
}

Expected<void> known(const std::string& name, const RuleSet& rules) {
  std::vector<std::string_view> names;
  for (const Component& each : rules.components)
    if (each.declared) names.push_back(each.name);
  if (std::ranges::find(names, name) != names.end()) return {};
  const std::string near = closest(name, {names.begin(), names.end()});
  return Error{"the rules have no component '" + name + "'" +
               (near.empty() ? "" : "; did you mean '" + near + "'?")};
}

// A slip in a DRILL line must not break the component that it was to spare.
Expected<void> all_known(const RuleSet& rules, const PlanOptions& options) {
  for (const std::string& name : options.only) {
    if (auto found = known(name, rules); !found) return found;
  }
  for (const DrillLine& line : rules.drills) {
    const std::string& name = rules[line.component].name;
    if (auto found = known(name, rules); !found)
      return Error{"DRILL " + name + ": " + found.error()};
  }
  return {};
}

// Until the slowest rule about it has noticed and its slowest strategy took effect.
Duration reaction(const std::string& component, const RuleSet& rules) {
  Duration most = std::chrono::seconds(2);
  for (const Rule& rule : rules.rules) {
    for (const StrategyId s : rule.strategies) {
      const auto is_it = [&](ComponentId c) { return rules[c].name == component; };
      if (std::ranges::any_of(rules[s].components, is_it))
        most = std::max(most, rule.policies.hold_for + duration_of(rules[s].impact, rules) +
                                  std::chrono::seconds(2));
    }
  }
  return most;
}

}  // namespace

std::string Step::id() const { return to_string(faults) + " #" + std::to_string(round); }

Duration estimate(const Step& step, const RuleSet& rules, const PlanOptions& options) {
  Duration most{};
  for (const Fault& fault : step.faults) {
    most = std::max(
        most, reaction(fault.component, rules) + (lasts(fault.kind) ? options.hang : Duration{}));
  }
  return most + kCalm;
}

Expected<DrillPlan> plan(const RuleSet& rules, const PlanOptions& options) {
  if (auto found = all_known(rules, options); !found) return Error{found.error()};
  DrillPlan out;
  std::vector<std::vector<Fault>> singles;
  std::vector<std::string> breakable;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const std::string& name = rules.components[c].name;
    if (!options.only.empty() && std::ranges::find(options.only, name) == options.only.end())
      continue;
    if (std::string why = why_spared(ComponentId(c), rules, options); !why.empty()) {
      out.left_out.emplace(name, std::move(why));
      continue;
    }
    breakable.push_back(name);
    for (const FaultKind kind : kFaultKinds) {
      if (kind != FaultKind::kSetParameter && is_wanted(kind, name, rules, options))
        singles.push_back({Fault{kind, name}});
    }
  }
  for (const DrillLine& line : rules.drills) {
    const std::string& name = rules[line.component].name;
    if (line.what == DrillLine::What::kSetParameter &&
        std::ranges::find(breakable, name) != breakable.end() &&
        is_wanted(FaultKind::kSetParameter, name, rules, options))
      singles.push_back({Fault{FaultKind::kSetParameter, name, line.subject, line.value}});
  }
  if (options.pairs) {
    auto pairs = pairs_of(breakable, rules);
    std::ranges::move(pairs, std::back_inserter(singles));
  }
  std::map<std::string, std::int64_t> broken;  // how often
  const auto is_at_limit = [&](const Fault& fault) {
    return broken[fault.component] >= limit_of(fault.component, rules);
  };
  std::mt19937_64 random(options.seed);
  for (int round = 1; round <= options.times; ++round) {
    shuffle(singles, random);
    for (const auto& faults : singles) {
      if (std::ranges::any_of(faults, is_at_limit)) continue;
      const Step step{faults, round};
      const Duration with_it = out.estimate + estimate(step, rules, options);
      if (out.beyond_budget > 0 || (options.budget && with_it > *options.budget)) {
        ++out.beyond_budget;
        continue;
      }
      out.estimate = with_it;
      for (const Fault& fault : faults) ++broken[fault.component];
      out.steps.push_back(step);
    }
  }
  return out;
}

std::string limit_reached(const Step& step, const std::vector<Trial>& trials,
                          const RuleSet& rules) {
  for (const Fault& fault : step.faults) {
    const auto breaks = [&](const Trial& trial) {
      return trial.injected > 0 && std::ranges::any_of(trial.faults, [&](const Fault& each) {
               return each.component == fault.component;
             });
    };
    const std::int64_t limit = limit_of(fault.component, rules);
    if (std::ranges::count_if(trials, breaks) >= limit)
      return fmt::format("DRILL {} limit {}", fault.component, limit);
  }
  return "";
}

std::vector<std::string> plan_lines(const DrillPlan& plan, const PlanOptions& options) {
  std::map<std::string, int> times;
  for (const Step& step : plan.steps) ++times[to_string(step.faults)];
  std::vector<std::string> lines;
  for (const auto& [fault, count] : times) {
    lines.push_back(count == 1 ? fault : fmt::format("{}, {} times", fault, count));
    if (fault.starts_with("hang") || fault.starts_with("slow") || fault.starts_with("loss"))
      lines.back() += " for " + in_words(options.hang);
  }
  for (const auto& [component, why] : plan.left_out)
    lines.push_back(fmt::format("{} is left alone: {}", component, why));
  if (plan.beyond_budget > 0)
    lines.push_back(fmt::format("{} more do not fit into the budget", plan.beyond_budget));
  lines.push_back(fmt::format("{} in random order (seed {}), about {}",
                              amount_of(plan.steps.size(), "fault"), options.seed,
                              in_words(plan.estimate)));
  return lines;
}

}  // namespace culprit::drill
