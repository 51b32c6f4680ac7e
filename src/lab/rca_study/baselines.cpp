#include "rca_study/baselines.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "diagnose/reach.h"
#include "plan/cost.h"
#include "plan/ties.h"
#include "plan/validity.h"

namespace culprit::study::rca {
namespace {

// By active rule: which active rules (places among them) are upstream of it.
std::vector<std::vector<std::size_t>> upstream(const Knowledge& knowledge) {
  const auto& active = knowledge.states.active();
  std::vector<ComponentId> touched;
  for (const RuleId rule : active) {
    const auto& components = knowledge.rules[rule].components;
    touched.insert(touched.end(), components.begin(), components.end());
  }
  const diagnose::Reach reach(knowledge, touched);
  std::vector<std::vector<std::size_t>> touching(reach.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    for (const ComponentId c : knowledge.rules[active[i]].components)
      touching[reach.place_of(c)].push_back(i);
  }
  std::vector<std::vector<std::size_t>> all(active.size());
  for (std::size_t i = 0; i < active.size(); ++i) {
    for (const ComponentId own : knowledge.rules[active[i]].components) {
      const std::size_t place = reach.place_of(own);
      diagnose::for_each(reach.upstream(place), [&](std::size_t up) {
        if (up == place) return;  // through a circle
        std::copy_if(touching[up].begin(), touching[up].end(), std::back_inserter(all[i]),
                     [&](std::size_t j) { return j != i; });
      });
    }
  }
  return all;
}

// The negated share of time that a walker spends at each.
std::vector<double> walk(const std::vector<std::vector<std::size_t>>& upstream) {
  constexpr double kJump = 0.15;
  constexpr int kSteps = 50;
  const auto size = static_cast<double>(upstream.size());
  std::vector<double> share(upstream.size(), 1 / size);
  for (int step = 0; step < kSteps; ++step) {
    std::vector<double> next(upstream.size(), kJump / size);
    for (std::size_t i = 0; i < upstream.size(); ++i) {
      const double moving = (1 - kJump) * share[i];
      if (upstream[i].empty()) next[i] += moving;
      const double to_each = moving / static_cast<double>(upstream[i].size());
      for (const std::size_t j : upstream[i]) next[j] += to_each;
    }
    share = std::move(next);
  }
  for (double& each : share) each = -each;
  return share;
}

}  // namespace

Decision cheapest_first(RuleId failure, const Knowledge& knowledge) {
  Decision decision{failure, {}, true, {}, {}};
  for (const StrategyId id : knowledge.rules[failure].strategies) {
    const Strategy& strategy = knowledge.rules[id];
    Candidate candidate;
    candidate.strategy = id;
    candidate.cost =
        plan::cost(knowledge.beliefs[id].mean(), strategy.impact, knowledge.rules.heaviest);
    if (knowledge.states.is_tried(id)) {
      candidate.excluded = Condition::kTried;
    } else if (const auto invalid = plan::invalidity(strategy, knowledge)) {
      candidate.excluded = Condition::kInvalid;
      candidate.component = invalid->component;
      candidate.remark = invalid->reason;
    } else {
      decision.is_spent = false;
    }
    decision.candidates.push_back(std::move(candidate));
  }
  std::stable_sort(decision.candidates.begin(), decision.candidates.end(),
                   [](const Candidate& a, const Candidate& b) {
                     return plan::parts(a.cost) < plan::parts(b.cost);
                   });
  return decision;
}

std::vector<double> RankingPlanner::ranks(const Knowledge& knowledge) const {
  std::vector<double> ranks;
  if (ranking_ == Ranking::kFirstFailing) {
    for (const RuleId rule : knowledge.states.active())
      ranks.push_back(seconds(knowledge.states[rule].failing_since.time_since_epoch()));
    return ranks;
  }
  const auto causes = upstream(knowledge);
  if (ranking_ == Ranking::kRandomWalk) return walk(causes);
  for (const auto& of_one : causes) ranks.push_back(static_cast<double>(of_one.size()));
  return ranks;
}

std::vector<Decision> RankingPlanner::plan(std::span<const RuleId> failures,
                                           const Knowledge& knowledge) const {
  const auto& active = knowledge.states.active();
  if (failures.empty()) return {};
  const std::vector<double> rank = ranks(knowledge);
  std::vector<std::size_t> order(active.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
  std::optional<RuleId> first;
  for (const RuleId rule : active) {
    if (knowledge.states[rule].attempt) first = rule;
  }
  std::vector<Decision> decisions;
  for (const std::size_t place : order) {
    const RuleId rule = active[place];
    if (!std::binary_search(failures.begin(), failures.end(), rule)) continue;
    Decision decision = cheapest_first(rule, knowledge);
    for (Candidate& candidate : decision.candidates) {
      if (candidate.excluded) continue;
      if (!first) {
        decision.chosen = candidate.strategy;
        first = rule;
      } else if (first == rule) {
        candidate.excluded = Condition::kOneEach;
      } else {
        candidate.excluded = Condition::kDependency;
        candidate.component = knowledge.rules[*first].components.front();
        candidate.failure = first;
      }
    }
    decisions.push_back(std::move(decision));
  }
  return decisions;
}

}  // namespace culprit::study::rca
