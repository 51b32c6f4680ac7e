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

// By component, how many connectors join it with others, as mRUBiS counts: one for each pair of a
// producer and a consumer.
std::vector<double> connectors(const Knowledge& knowledge) {
  std::vector<double> by_vertex(knowledge.graph.size());
  knowledge.graph.for_each_channel([&](std::span<const DependencyGraph::Vertex> producers,
                                       std::span<const DependencyGraph::Vertex> consumers) {
    for (const auto producer : producers) {
      for (const auto consumer : consumers) {
        if (producer == consumer) continue;
        by_vertex[producer] += 1;
        by_vertex[consumer] += 1;
      }
    }
  });
  std::vector<double> counts;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const auto vertex = knowledge.graph.vertex_of(ComponentId(c));
    counts.push_back(vertex ? by_vertex[*vertex] : 0);
  }
  return counts;
}

// Finds the reason why a strategy cannot be executed now, apart from the other chosen strategies.
void examine(Candidate& candidate, const std::vector<ComponentId>& affected,
             const Knowledge& knowledge) {
  if (plan::is_excluded_alone(candidate, knowledge)) {
    // They wait for nothing.
    if (candidate.excluded == Condition::kUnheard) candidate.excluded = Condition::kInvalid;
    return;
  }
  for (const ComponentId component : knowledge.rules[candidate.strategy].components) {
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

std::map<StrategyId, double> StylePlanner::worths(std::span<const RuleId> failures,
                                                  const Knowledge& knowledge) const {
  std::vector<double> connected;
  if (style_ == Style::kGhahremani) connected = connectors(knowledge);
  std::map<StrategyId, double> all;
  for (const RuleId rule : failures) {
    const Rule& wrong = knowledge.rules[rule];
    double utility = 1;
    if (style_ == Style::kGhahremani) {
      utility = 0;
      for (const ComponentId component : wrong.components) utility += connected[component.index];
      utility *= 1 + static_cast<double>(wrong.policies.criticality);
    }
    for (const StrategyId id : wrong.strategies) {
      const auto cycles = std::max<std::int64_t>(1, knowledge.rules[id].impact.count);
      const double success = knowledge.beliefs[id].mean().value;
      all[id] = style_ == Style::kRebet        ? 0
                : style_ == Style::kGhahremani ? success * utility / static_cast<double>(cycles)
                                               : success;
    }
  }
  return all;
}

std::vector<Decision> StylePlanner::plan(std::span<const RuleId> failures,
                                         const Knowledge& knowledge) const {
  const std::map<StrategyId, double> worth = worths(failures, knowledge);
  const auto is_worthier = [&](StrategyId a, StrategyId b) {
    return plan::parts(worth.at(a)) > plan::parts(worth.at(b));
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
  for (Decision& decision : decisions) choose(decision, affected, knowledge);
  return decisions;
}

// `affected`: components that a strategy chosen before adapts.
void StylePlanner::choose(Decision& decision, std::vector<ComponentId>& affected,
                          const Knowledge& knowledge) const {
  const std::optional<RuleId> first = comes_first(decision.rule, knowledge);
  decision.is_spent = true;
  for (Candidate& candidate : decision.candidates) {
    const bool is_predefined = candidate.strategy == decision.candidates.front().strategy;
    examine(candidate, affected, knowledge);
    const bool is_out =
        candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid;
    if (has_one_strategy() && !is_predefined) {
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

}  // namespace culprit::study
