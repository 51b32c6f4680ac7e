#include "rca_study/optimum.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

// Costs that differ by less are the same.
constexpr double kTie = 1e-9;

// All of a situation as bytes. Weights that differ by rounding are the same.
std::string key_of(const Situation& situation) {
  std::string key;
  const auto add = [&](std::uint64_t number, int bytes) {
    for (int b = 0; b < bytes; ++b) key += static_cast<char>(number >> (8 * b) & 0xFF);
  };
  add(situation.ill, 1);
  add(situation.gone, 1);
  for (const Situation::Tries& tries : situation.tries)
    add(std::uint64_t{tries.tried} | std::uint64_t{tries.turns} << 4, 1);
  constexpr double kParts = 1e9;
  for (const Situation::Hypothesis& h : situation.belief) {
    add(h.faulty, 1);
    add(h.passing, 2);
    add(static_cast<std::uint64_t>(std::llround(h.weight * kParts)), 4);
  }
  return key;
}

// Follows one planner through all that can happen.
class Followed {
 public:
  Followed(const RepairProcess& process, const RuleSet& rules, const Planner& planner)
      : process_(process), planner_(planner), knowledge_(rules) {
    process.connect(knowledge_.graph);
  }

  double cost(const Situation& situation) {
    if (situation.ill == 0) return 0;
    const auto [known, is_new] = known_.try_emplace(key_of(situation), 0);
    if (!is_new) return known->second;
    const Round round = decided(situation);
    double sum = process_.cost_of_leaving_it_ill(situation);
    if (!round.empty()) {
      sum = process_.cost(situation, round);
      for (const RepairProcess::Outcome& outcome : process_.outcomes(situation, round))
        sum += outcome.probability * cost(outcome.situation);
    }
    return known_[key_of(situation)] = sum;
  }

 private:
  Round decided(const Situation& situation) {
    if (!process_.is_open(situation)) return {};
    process_.show(situation, knowledge_);
    Round round;
    for (const Decision& decision : planner_.plan(knowledge_.states.active(), knowledge_)) {
      if (!decision.chosen) continue;
      const auto& all = knowledge_.rules[decision.rule].strategies;
      const auto place = std::find(all.begin(), all.end(), *decision.chosen) - all.begin();
      round.push_back({decision.rule.index, static_cast<std::size_t>(place)});
    }
    return round;
  }

  const RepairProcess& process_;
  const Planner& planner_;
  Knowledge knowledge_;
  std::unordered_map<std::string, double> known_;
};

// After a failure came or went, how long nothing is begun: its effects have to show.
constexpr Duration kLook = std::chrono::milliseconds(1500);

class OptimumPlanner : public Planner {
 public:
  OptimumPlanner(const RcaScenario& scenario, Objective objective)
      : rules_(rules_of(scenario)), process_(scenario, rules_, objective), optimum_(process_) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    Round round;
    if (may_begin(knowledge)) {
      const auto situation = process_.situation_of(knowledge);
      if (situation && process_.is_open(*situation)) round = optimum_.round(*situation);
    }
    std::vector<Decision> decisions;
    for (const RuleId rule : failures) decisions.push_back(decision(rule, round, knowledge));
    return decisions;
  }

 private:
  bool may_begin(const Knowledge& knowledge) const {
    for (std::size_t r = 0; r < process_.size(); ++r) {
      const RuleState& state = knowledge.states[RuleId(r)];
      const bool is_active = knowledge.states.is_active(RuleId(r));
      const Time changed = is_active ? state.failing_since : state.gone_since;
      if (state.attempt || knowledge.now < later(changed, kLook)) return false;
    }
    return true;
  }

  Decision decision(RuleId rule, const Round& round, const Knowledge& knowledge) const {
    Decision decision{rule, {}, true, {}, {}};
    const auto& strategies = knowledge.rules[rule].strategies;
    for (std::size_t t = 0; t < strategies.size(); ++t) {
      const bool is_chosen = std::any_of(round.begin(), round.end(), [&](const Treated& treated) {
        return treated.component == rule.index && treated.treatment == t;
      });
      Candidate candidate;
      candidate.strategy = strategies[t];
      candidate.component = ComponentId(rule.index);
      if (is_chosen) {
        decision.chosen = strategies[t];
      } else {
        candidate.excluded =
            knowledge.states[rule].search.tried[t] ? Condition::kTried : Condition::kOneEach;
      }
      decision.is_spent &= candidate.excluded == Condition::kTried;
      decision.candidates.push_back(candidate);
    }
    return decision;
  }

  RuleSet rules_;
  RepairProcess process_;
  mutable Optimum optimum_;  // what was worked out is remembered
};

}  // namespace

// Branch and bound: the round that may cost least is examined first; a round that must cost more
// than a known one is not.
const Optimum::Best& Optimum::best(const Situation& situation) {
  // If all is known, the other ill components do not matter.
  if (const auto told = process_.told_by_itself(situation)) return best(*told);
  const std::string key = key_of(situation);
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  Best best;
  if (situation.ill != 0) best.cost = process_.cost_of_leaving_it_ill(situation);
  if (process_.is_open(situation)) {
    std::vector<Begun> all;
    for (Round& round : process_.rounds(situation)) {
      Begun begun{process_.cost(situation, round), all.size(), std::move(round), {}};
      begun.outcomes = process_.outcomes(situation, begun.round);
      for (const RepairProcess::Outcome& outcome : begun.outcomes)
        begun.least += outcome.probability * least(outcome.situation);
      all.push_back(std::move(begun));
    }
    std::sort(all.begin(), all.end(), [](const Begun& a, const Begun& b) {
      return std::pair(a.least, a.place) < std::pair(b.least, b.place);
    });
    std::size_t first = all.size();
    for (Begun& begun : all) {
      if (begun.least > best.cost + kTie) break;
      const double sum = cost_below(begun, best.cost + kTie);
      // Among equal costs, the first round is kept.
      if (sum < best.cost - kTie || (sum < best.cost + kTie && begun.place < first)) {
        best = {sum, std::move(begun.round)};
        first = begun.place;
      }
    }
  }
  return known_.emplace(key, std::move(best)).first->second;
}

// Of beginning so; or anything from `limit` on, if it is not less than that.
double Optimum::cost_below(const Begun& begun, double limit) {
  double sum = begun.least;
  for (const RepairProcess::Outcome& outcome : begun.outcomes) {
    if (sum >= limit) break;
    sum += outcome.probability * (cost(outcome.situation) - least(outcome.situation));
  }
  return sum;
}

double Optimum::least(const Situation& situation) {
  if (process_.is_told(situation)) return 0;
  double sum = 0;
  for (std::size_t h = 0; h < situation.belief.size();) {
    const Members faulty = situation.belief[h].faulty;
    double weight = 0;
    for (; h < situation.belief.size() && situation.belief[h].faulty == faulty; ++h)
      weight += situation.belief[h].weight;
    sum += weight * cost(process_.told(situation, faulty));
  }
  return sum;
}

double Optimum::cost() {
  double sum = 0;
  for (const RepairProcess::Outcome& beginning : process_.beginnings())
    sum += beginning.probability * cost(beginning.situation);
  return sum;
}

double expected_cost(const RepairProcess& process, const RuleSet& rules, const Planner& planner) {
  Followed followed(process, rules, planner);
  double sum = 0;
  for (const RepairProcess::Outcome& beginning : process.beginnings())
    sum += beginning.probability * followed.cost(beginning.situation);
  return sum;
}

std::unique_ptr<const Planner> optimum_planner(const RcaScenario& scenario, Objective objective) {
  CULPRIT_ASSERT(RepairProcess::is_small(scenario));
  return std::make_unique<OptimumPlanner>(scenario, objective);
}

}  // namespace culprit::study::rca
