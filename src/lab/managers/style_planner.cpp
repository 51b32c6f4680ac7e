#include "managers/style_planner.h"

#include <algorithm>
#include <array>
#include <utility>

#include "plan/ties.h"
#include "plan/validity.h"

namespace culprit::study {
namespace {

constexpr std::array<std::pair<std::string_view, Style>, 4> kStyles = {{
    {"rebet", Style::kRebet},
    {"ac-ros", Style::kAcRos},
    {"vogel", Style::kVogel},
    {"ghahremani", Style::kGhahremani},
}};

double value_of(RuleId rule, const Knowledge& knowledge) {
  const Rule& wrong = knowledge.rules[rule];
  double depending = 0;
  for (const ComponentId component : wrong.components)
    depending += 1 + static_cast<double>(knowledge.graph.downstream(component).size());
  return (1 + static_cast<double>(wrong.policies.criticality)) * depending;
}

// Finds the reason why a strategy cannot be executed now, apart from the other chosen strategies.
void examine(Candidate& candidate, const std::vector<ComponentId>& affected,
             const Knowledge& knowledge) {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  if (knowledge.states.is_tried(candidate.strategy)) {
    candidate.excluded = Condition::kTried;
    return;
  }
  if (auto invalid = plan::invalidity(strategy, knowledge)) {
    candidate.excluded = Condition::kInvalid;
    candidate.component = invalid->component;
    candidate.remark = std::move(invalid->reason);
    return;
  }
  if (const auto& reason = knowledge.withheld[candidate.strategy.index].reason; !reason.empty()) {
    candidate.excluded = Condition::kWithheld;
    candidate.component = strategy.components.front();
    candidate.remark = reason;
    return;
  }
  for (const ComponentId component : strategy.components) {
    const bool is_affected =
        std::find(affected.begin(), affected.end(), component) != affected.end();
    if (!is_affected && knowledge.states.reservation(component) == nullptr) continue;
    candidate.excluded = is_affected ? Condition::kAffected : Condition::kAdapting;
    candidate.component = component;
    return;
  }
}

}  // namespace

std::optional<Style> find_style(std::string_view name) {
  const auto found = std::find_if(kStyles.begin(), kStyles.end(),
                                  [&](const auto& each) { return each.first == name; });
  return found == kStyles.end() ? std::nullopt : std::optional(found->second);
}

std::optional<RuleId> StylePlanner::comes_first(RuleId rule, const Knowledge& knowledge) const {
  const auto is_repair = [&](RuleId id) {
    return knowledge.rules[id].policies.criticality == Criticality::kError;
  };
  if (style_ != Style::kVogel || is_repair(rule)) return std::nullopt;
  const auto& active = knowledge.states.active();
  const auto found = std::find_if(active.begin(), active.end(), is_repair);
  return found == active.end() ? std::nullopt : std::optional(*found);
}

double StylePlanner::worth(StrategyId id, const Knowledge& knowledge) const {
  const Strategy& strategy = knowledge.rules[id];
  const double success = knowledge.beliefs[id].mean().value;
  switch (style_) {
    case Style::kRebet:
      return 0;
    case Style::kAcRos:
    case Style::kVogel:
      return success;
    case Style::kGhahremani:
      break;
  }
  const auto cycles = static_cast<double>(std::max<std::int64_t>(1, strategy.impact.count));
  return success * value_of(strategy.rule, knowledge) / cycles;
}

std::vector<Decision> StylePlanner::plan(std::span<const RuleId> failures,
                                         const Knowledge& knowledge) const {
  const auto is_worthier = [&](StrategyId a, StrategyId b) {
    return plan::parts(worth(a, knowledge)) > plan::parts(worth(b, knowledge));
  };
  std::vector<Decision> decisions;
  for (const RuleId id : failures) {
    const Rule& rule = knowledge.rules[id];
    std::vector<StrategyId> order = ranking_ ? ranking_(rule) : rule.strategies;
    std::stable_sort(order.begin(), order.end(), is_worthier);
    Decision& decision = decisions.emplace_back();
    decision.rule = id;
    for (const StrategyId each : order) decision.candidates.emplace_back().strategy = each;
  }
  if (style_ == Style::kGhahremani) {
    std::stable_sort(decisions.begin(), decisions.end(), [&](const Decision& a, const Decision& b) {
      return is_worthier(a.candidates.front().strategy, b.candidates.front().strategy);
    });
  }
  std::vector<ComponentId> affected;
  for (Decision& decision : decisions) {
    const std::optional<RuleId> first = comes_first(decision.rule, knowledge);
    decision.is_spent = true;
    for (Candidate& candidate : decision.candidates) {
      const bool is_predefined = candidate.strategy == decision.candidates.front().strategy;
      examine(candidate, affected, knowledge);
      const bool is_out =
          candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid;
      if (style_ == Style::kAcRos && !is_predefined) {
        candidate.excluded = Condition::kOneEach;
        continue;
      }
      decision.is_spent &= is_out;
      if (candidate.excluded) continue;
      if (first) {
        candidate.excluded = Condition::kInTheWay;
        candidate.component = knowledge.rules[*first].components.front();
        candidate.failure = first;
      } else if (decision.chosen) {
        candidate.excluded = Condition::kOneEach;
      } else {
        decision.chosen = candidate.strategy;
        const auto& adapted = knowledge.rules[candidate.strategy].components;
        affected.insert(affected.end(), adapted.begin(), adapted.end());
      }
    }
  }
  return decisions;
}

}  // namespace culprit::study
