#include "rca_study/repair_process.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "plan/bayes/value.h"

namespace culprit::study::rca {
namespace {

using Hypothesis = Situation::Hypothesis;
using namespace std::chrono_literals;

constexpr double kCrash = 1.0 / kFaultKinds;  // the share of the faults that are crashes

constexpr Members one(std::size_t member) { return Members{1} << member; }
constexpr bool has(Members set, std::size_t member) { return (set >> member & 1) != 0; }

const Treatment& treatment(const RcaScenario& scenario, const Treated& treated) {
  return scenario.components[treated.component].treatments[treated.treatment];
}

std::size_t subscriptions(const RcaScenario& scenario) {
  std::size_t count = 0;
  for (const RcaTopic& topic : scenario.topics) {
    count +=
        static_cast<std::size_t>(std::count_if(topic.subscribers.begin(), topic.subscribers.end(),
                                               [](const Subscription& s) { return s.passes > 0; }));
  }
  return count;
}

double binomial(std::size_t n, std::size_t k) {
  double ways = k > n ? 0 : 1;
  for (std::size_t i = 0; i < k && ways > 0; ++i)
    ways *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  return ways;
}

// Adds up the same hypotheses, and has all sum to one.
std::vector<Hypothesis> merged(std::vector<Hypothesis> belief) {
  std::sort(belief.begin(), belief.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return std::pair(a.faulty, a.passing) < std::pair(b.faulty, b.passing);
  });
  std::vector<Hypothesis> all;
  double sum = 0;
  for (const Hypothesis& h : belief) {
    sum += h.weight;
    const bool is_same =
        !all.empty() && all.back().faulty == h.faulty && all.back().passing == h.passing;
    is_same ? void(all.back().weight += h.weight) : all.push_back(h);
  }
  for (Hypothesis& h : all) h.weight /= sum;
  return all;
}

}  // namespace

void RepairProcess::connect(DependencyGraph& graph) const {
  const auto node = [&](std::size_t c) { return "/" + scenario_.components[c].name; };
  for (std::size_t c = 0; c < size(); ++c) graph.node_appeared(node(c));
  for (const RcaTopic& topic : scenario_.topics) {
    for (const std::size_t p : topic.publishers)
      graph.endpoint_appeared(node(p), EndpointKind::kPublisher, topic.name);
    for (const Subscription& s : topic.subscribers) {
      if (!s.is_hidden)
        graph.endpoint_appeared(node(s.component), EndpointKind::kSubscriber, topic.name);
    }
  }
}

bool RepairProcess::is_small(const RcaScenario& scenario) {
  const bool is_all_seen = std::none_of(
      scenario.components.begin(), scenario.components.end(),
      [](const RcaComponent& c) { return c.is_unwatched || c.detector.false_alarms_per_min > 0; });
  return is_all_seen && scenario.common_causes.empty() &&
         scenario.components.size() <= kMostComponents && scenario.faults.size() <= kMostFaults &&
         !scenario.faults.empty() && subscriptions(scenario) <= kMostSubscriptions;
}

RepairProcess::RepairProcess(const RcaScenario& scenario, const RuleSet& rules, Objective objective)
    : scenario_(scenario),
      rules_(rules),
      weights_(weights(objective)),
      upstream_(size()),
      dependents_(size()),
      redundant_(size()) {
  for (const RcaTopic& topic : scenario.topics) {
    Members from = 0;
    for (const std::size_t p : topic.publishers) from |= one(p);
    for (const Subscription& s : topic.subscribers) {
      if (s.is_redundant) redundant_[s.component] += topic.publishers.size();
      if (s.passes > 0) paths_.push_back({from, s.component, s.passes, s.is_redundant});
    }
  }
  DependencyGraph graph(rules);
  connect(graph);
  for (std::size_t c = 0; c < size(); ++c) {
    for (const ComponentId up : graph.upstream(ComponentId(c))) upstream_[c] |= one(up.index);
    dependents_[c] = graph.downstream(ComponentId(c)).size();
  }
  for (Members faulty = 0; faulty < one(size()); ++faulty) {
    for (Members passing = 0; passing < one(paths_.size()); ++passing)
      ill_.push_back(spread(faulty, passing));
  }
  tell_apart();
  for (Members ill = 0; ill < one(size()); ++ill) {
    double& worst = gravity_.emplace_back(0);
    for (std::size_t c = 0; c < size(); ++c) {
      if (has(ill, c))
        worst = std::max(worst, plan::weight(scenario.components[c].criticality) /
                                    plan::weight(Criticality::kError));
    }
  }
}

Members RepairProcess::spread(Members faulty, Members passing) const {
  Members ill = faulty;
  for (bool is_more = true; is_more;) {
    is_more = false;
    std::vector<std::size_t> redundant(size());
    const auto add = [&](std::size_t c) {
      is_more |= !has(ill, c);
      ill |= one(c);
    };
    for (std::size_t w = 0; w < paths_.size(); ++w) {
      const Way& way = paths_[w];
      if (!has(passing, w) || (way.from & ill) == 0) continue;
      if (!way.is_redundant) add(way.to);
      redundant[way.to] += static_cast<std::size_t>(std::popcount(way.from & ill));
      if (way.is_redundant && redundant[way.to] >= redundant_[way.to]) add(way.to);
    }
  }
  return ill;
}

// Faults only end. So two sets of subscriptions are alike for `faulty` if they make the same components ill for it, and are alike for it without any one of its
// faults.
void RepairProcess::tell_apart() {
  alike_.resize(ill_.size());
  for (Members faulty = 0; faulty < one(size()); ++faulty) {
    std::map<std::vector<Members>, Members> first;
    for (Members passing = 0; passing < one(paths_.size()); ++passing) {
      std::vector<Members> shown{ill(faulty, passing)};
      for (std::size_t c = 0; c < size(); ++c) {
        if (has(faulty, c)) shown.push_back(alike(faulty & ~one(c), passing));
      }
      alike_[place(faulty, passing)] = first.try_emplace(std::move(shown), passing).first->second;
    }
  }
}

double RepairProcess::probability_of(Members passing) const {
  double probability = 1;
  for (std::size_t w = 0; w < paths_.size(); ++w)
    probability *= has(passing, w) ? paths_[w].passes : 1 - paths_[w].passes;
  return probability;
}

std::vector<RepairProcess::Outcome> RepairProcess::beginnings() const {
  Sorted sorted;
  const auto faults = static_cast<int>(scenario_.faults.size());
  for (Members faulty = 0; faulty < one(size()); ++faulty) {
    if (std::popcount(faulty) != faults) continue;
    for (Members passing = 0; passing < one(paths_.size()); ++passing) {
      const double of_both =
          probability_of(passing) / binomial(size(), static_cast<std::size_t>(faults));
      if (of_both == 0) continue;
      const Members ill_now = ill(faulty, passing);
      for (Members gone = faulty;; gone = (gone - 1) & faulty) {
        const int crashes = std::popcount(gone);
        const double weight =
            of_both * std::pow(kCrash, crashes) * std::pow(1 - kCrash, faults - crashes);
        sorted[{ill_now, gone}].push_back({faulty, passing, weight});
        if (gone == 0) break;
      }
    }
  }
  std::vector<Outcome> all;
  for (auto& [seen, belief] : sorted) {
    double probability = 0;
    for (const Hypothesis& h : belief) probability += h.weight;
    all.push_back(
        {probability, settled(seen, std::move(belief), std::vector<Situation::Tries>(size()))});
  }
  return all;
}

// Forgets what no longer matters: the tries of those that are well, and which subscriptions pass as
// far as nothing that may still be seen depends on it.
Situation RepairProcess::settled(Seen seen, std::vector<Hypothesis> belief,
                                 std::vector<Situation::Tries> tries) const {
  for (Hypothesis& h : belief) h.passing = alike(h.faulty, h.passing);
  Situation situation{seen.first, seen.second, std::move(tries), merged(std::move(belief))};
  for (std::size_t c = 0; c < size(); ++c) {
    Situation::Tries& of_one = situation.tries[c];
    if (!has(situation.ill, c)) {
      of_one = {};
    } else if ((valid(situation, c) & ~of_one.tried) == 0) {
      ++of_one.turns;
      of_one.tried = 0;
    }
  }
  return situation;
}

// The treatments that make sense: a process that is gone answers no request.
std::uint8_t RepairProcess::valid(const Situation& situation, std::size_t component) const {
  std::uint8_t all = 0;
  const auto& treatments = scenario_.components[component].treatments;
  for (std::size_t t = 0; t < treatments.size(); ++t) {
    if (!has(situation.gone, component) || treatments[t].repair == Repair::kRedeploy)
      all = static_cast<std::uint8_t>(all | 1U << t);
  }
  return all;
}

// m_t
std::vector<int> RepairProcess::vain(const Situation& situation, std::size_t component) const {
  const Situation::Tries& tries = situation.tries[component];
  std::vector<int> all(scenario_.components[component].treatments.size(), 0);
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (has(valid(situation, component), t)) all[t] = tries.turns + (tries.tried >> t & 1);
  }
  return all;
}

namespace {

// p_k prod_t (1 - h_tk)^m_t, by kind
std::array<double, kFaultKinds> kinds(const RcaComponent& component, bool is_gone,
                                      const std::vector<int>& vain) {
  std::array<double, kFaultKinds> weights{};
  for (std::size_t k = 0; k < kFaultKinds; ++k) {
    const bool is_possible = (static_cast<FaultKind>(k) == FaultKind::kCrash) == is_gone;
    if (!is_possible) continue;
    weights[k] = is_gone ? 1 : 1.0 / (kFaultKinds - 1);
    for (std::size_t t = 0; t < vain.size(); ++t)
      for (int v = 0; v < vain[t]; ++v) weights[k] *= 1 - component.treatments[t].helps[k];
  }
  return weights;
}

}  // namespace

double RepairProcess::likelihood(const Situation& situation, std::size_t component) const {
  double sum = 0;
  for (const double weight : kinds(scenario_.components[component], has(situation.gone, component),
                                   vain(situation, component)))
    sum += weight;
  return sum;
}

double RepairProcess::success(const Situation& situation, const Treated& treated) const {
  const auto weights =
      kinds(scenario_.components[treated.component], has(situation.gone, treated.component),
            vain(situation, treated.component));
  double sum = 0;
  double helped = 0;
  for (std::size_t k = 0; k < kFaultKinds; ++k) {
    sum += weights[k];
    helped += weights[k] * treatment(scenario_, treated).helps[k];
  }
  return sum > 0 ? helped / sum : 0;
}

std::vector<RepairProcess::Outcome> RepairProcess::outcomes(const Situation& situation,
                                                            const Round& round) const {
  std::vector<double> helps;
  std::vector<Situation::Tries> tries = situation.tries;
  for (const Treated& treated : round) {
    helps.push_back(success(situation, treated));
    auto& tried = tries[treated.component].tried;
    tried = static_cast<std::uint8_t>(tried | 1U << treated.treatment);
  }
  Sorted sorted;
  for (const Hypothesis& h : situation.belief) {
    for (Members helped = 0; helped < one(round.size()); ++helped) {
      double weight = h.weight;
      Members faulty = h.faulty;
      for (std::size_t r = 0; r < round.size(); ++r) {
        const bool has_fault = has(h.faulty, round[r].component);
        // A component without a fault gives no further information.
        const double helps_it = has_fault ? helps[r] : 0;
        weight *= has(helped, r) ? helps_it : 1 - helps_it;
        if (has(helped, r)) faulty &= ~one(round[r].component);
      }
      if (weight > 0)
        sorted[{ill(faulty, h.passing), situation.gone & faulty}].push_back(
            {faulty, h.passing, weight});
    }
  }
  std::vector<Outcome> all;
  for (auto& [seen, belief] : sorted) {
    double probability = 0;
    for (const Hypothesis& h : belief) probability += h.weight;
    all.push_back({probability, settled(seen, std::move(belief), tries)});
  }
  return all;
}

bool RepairProcess::is_exhausted(const Situation& situation, std::size_t component) const {
  return situation.tries[component].turns >= kTurns;
}

bool RepairProcess::is_open(const Situation& situation) const {
  for (std::size_t c = 0; c < size(); ++c) {
    if (has(situation.ill, c) && !is_exhausted(situation, c)) return true;
  }
  return false;
}

bool RepairProcess::interferes(const Situation& situation, std::size_t a, std::size_t b) const {
  const auto waits_for = [&](std::size_t consumer, std::size_t producer) {
    return has(upstream_[consumer], producer) && !has(situation.gone, consumer);
  };
  return a == b || waits_for(a, b) || waits_for(b, a);
}

std::vector<Round> RepairProcess::rounds(const Situation& situation) const {
  std::vector<Round> all(1);
  for (std::size_t c = 0; c < size(); ++c) {
    if (!has(situation.ill, c) || is_exhausted(situation, c)) continue;
    const auto open = static_cast<std::uint8_t>(valid(situation, c) & ~situation.tries[c].tried);
    const std::size_t before = all.size();
    for (std::size_t r = 0; r < before; ++r) {
      const bool is_free = std::none_of(all[r].begin(), all[r].end(), [&](const Treated& other) {
        return interferes(situation, c, other.component);
      });
      for (std::size_t t = 0; is_free && t < scenario_.components[c].treatments.size(); ++t) {
        if (!has(open, t)) continue;
        Round larger = all[r];
        larger.push_back({c, t});
        all.push_back(std::move(larger));
      }
    }
  }
  all.erase(all.begin());
  return all;
}

double RepairProcess::cost_of_leaving_it_ill(const Situation& situation) const {
  constexpr double kMany = 10;
  const double cycles = scenario_.horizon_s / seconds(rules_.cycle);
  return weights_.time * gravity(situation.ill) * cycles /
             static_cast<double>(rules_.heaviest.count) +
         kMany * (weights_.attempt + weights_.redeployment);
}

double RepairProcess::cost(const Situation& situation, const Round& round) const {
  int longest = 0;
  double sum = 0;
  for (const Treated& treated : round) {
    const Treatment& what = treatment(scenario_, treated);
    longest = std::max(longest, what.impact);
    plan::Effort effort{};
    effort.redeployments = what.repair == Repair::kRedeploy ? 1 : 0;
    if (what.repair != Repair::kConfigure)
      effort.disruption =
          static_cast<double>(1 + dependents_[treated.component]) / static_cast<double>(size());
    sum += plan::try_cost(effort, weights_, rules_);
  }
  const CostWeights of_time{.time = weights_.time * gravity(situation.ill)};
  return sum + plan::try_cost({Cycles{longest}}, of_time, rules_);
}

Situation RepairProcess::told(const Situation& situation, Members faulty) const {
  Situation known{faulty, situation.gone, situation.tries, {{faulty, 0, 1}}};
  for (std::size_t c = 0; c < size(); ++c) {
    if (!has(faulty, c)) known.tries[c] = {};
  }
  return known;
}

bool RepairProcess::is_told(const Situation& situation) const {
  const auto& belief = situation.belief;
  return belief.size() == 1 && belief.front().faulty == situation.ill &&
         belief.front().passing == 0;
}

std::optional<Situation> RepairProcess::told_by_itself(const Situation& situation) const {
  if (situation.belief.empty() || is_told(situation)) return std::nullopt;
  const Members all = situation.belief.front().faulty;
  std::array<std::optional<Members>, std::size_t{1} << kMostComponents> by_ill;
  for (const Hypothesis& h : situation.belief) {
    if (h.faulty != all) return std::nullopt;
    for (Members left = all;; left = (left - 1) & all) {
      auto& before = by_ill[ill(left, h.passing)];
      if (before.value_or(left) != left) return std::nullopt;
      if (gravity(ill(left, h.passing)) > gravity(left)) return std::nullopt;
      before = left;
      if (left == 0) break;
    }
  }
  return told(situation, all);
}

void RepairProcess::show(const Situation& situation, Knowledge& knowledge) const {
  knowledge.now = Time(100s);
  for (std::size_t c = 0; c < size(); ++c) {
    const RuleId rule(c);
    const bool is_ill = has(situation.ill, c);
    const bool is_gone = has(situation.gone, c);
    RuleState& state = knowledge.states.state(rule);
    state.detection.trigger = Slot::of(is_ill);
    state.failing_since = is_ill ? Time(50s) : kNever;
    state.search.round = situation.tries[c].turns;
    const bool is_failing = is_ill && !is_exhausted(situation, c);
    knowledge.states.enter(rule, is_failing ? RulePhase::kFailing
                                 : is_ill   ? RulePhase::kExhausted
                                            : RulePhase::kQuiet);
    knowledge.discovered.note(ComponentId(c), Time{});
    ComponentState& component = knowledge.components[ComponentId(c)];
    component.alive = !is_gone;
    component.process = is_gone ? ProcessState::kGone : ProcessState::kRunning;
    component.lifecycle = Lifecycle::kActive;
    const std::vector<int> failed = vain(situation, c);
    for (std::size_t t = 0; t < failed.size(); ++t) {
      const StrategyId id = rules_[rule].strategies[t];
      state.search.tried[t] = has(situation.tries[c].tried, t);
      const Treatment& what = scenario_.components[c].treatments[t];
      Belief belief = initial_belief({what.success / 100}, what.confidence);
      belief.beta += failed[t];
      knowledge.beliefs.set(id, belief);
    }
  }
}

std::optional<Situation> RepairProcess::situation_of(const Knowledge& knowledge) const {
  Situation now;
  now.tries.resize(size());
  for (std::size_t c = 0; c < size(); ++c) {
    const RuleState& state = knowledge.states[RuleId(c)];
    if (state.phase == RulePhase::kQuiet) continue;
    now.ill |= one(c);
    if (knowledge.components[ComponentId(c)].process == ProcessState::kGone) now.gone |= one(c);
    now.tries[c].turns = static_cast<std::uint8_t>(std::min(state.search.round, kTurns - 1));
    for (std::size_t t = 0; t < state.search.tried.size(); ++t) {
      if (state.search.tried[t])
        now.tries[c].tried = static_cast<std::uint8_t>(now.tries[c].tried | 1U << t);
    }
  }
  std::vector<Hypothesis> belief;
  const std::size_t well = size() - static_cast<std::size_t>(std::popcount(now.ill));
  for (Members faulty = now.ill; faulty != 0; faulty = (faulty - 1) & now.ill) {
    const auto count = static_cast<std::size_t>(std::popcount(faulty));
    if (count > scenario_.faults.size() || (now.gone & ~faulty) != 0) continue;
    // The other faults were at components that are well by now.
    double weight = binomial(well, scenario_.faults.size() - count);
    for (std::size_t c = 0; c < size(); ++c) {
      if (has(faulty, c)) weight *= likelihood(now, c) * (has(now.gone, c) ? kCrash : 1 - kCrash);
    }
    for (Members passing = 0; weight > 0 && passing < one(paths_.size()); ++passing) {
      if (ill(faulty, passing) == now.ill)
        belief.push_back({faulty, passing, weight * probability_of(passing)});
    }
  }
  if (belief.empty()) return std::nullopt;
  return settled({now.ill, now.gone}, std::move(belief), now.tries);
}

}  // namespace culprit::study::rca
