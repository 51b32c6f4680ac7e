#include "rca_study/learning.h"

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "rca_study/rca_robot.h"
#include "rca_study/rules.h"
#include "simulation/random.h"

namespace culprit::study::rca {
namespace {

class Learner {
 public:
  explicit Learner(const LearningCampaign& campaign)
      : campaign_(campaign),
        scenario_(generate(campaign.setting, simulation::mix(campaign.seed))),
        rules_(rules_of(scenario_)) {
    believe(campaign.priors);
    const Beliefs initial(rules_);
    truths_.resize(rules_.strategies.size());
    for (std::size_t s = 0; s < rules_.strategies.size(); ++s)
      beliefs_.push_back(initial[StrategyId(s)]);
  }

  void drift() {
    for (RcaComponent& component : scenario_.components) {
      auto& treatments = component.treatments;
      const auto place = [&](Repair repair) {
        return std::find_if(treatments.begin(), treatments.end(),
                            [&](const Treatment& t) { return t.repair == repair; });
      };
      std::swap(place(Repair::kConfigure)->helps, place(Repair::kRestart)->helps);
    }
  }

  std::size_t strategies() const { return beliefs_.size(); }

  // `result` may be null: nothing is measured.
  void play(std::uint64_t seed, LearningResult* result) {
    scenario_.seed = seed;
    for (Truth& truth : truths_) truth.pending.clear();
    scenario_.faults = random_faults(campaign_.setting, simulation::mix(seed));
    RcaRobot robot(scenario_, rules_, kQuiet);
    Manager::Options options;
    options.discovery = Duration::zero();
    options.forgetting = campaign_.forgetting;
    options.governor.limits.backoff.healthy = kHealthy;
    Manager manager(rules_, planner(), options);
    for (std::size_t s = 0; s < beliefs_.size(); ++s)
      manager.set_belief(StrategyId(s), beliefs_[s]);
    for (const auto& [pair, coupling] : couplings_)
      manager.set_coupling(pair.first, pair.second, coupling);
    Runtime runtime(manager, robot);
    robot.on_effect = [&](std::size_t component, Repair repair, bool has_helped) {
      note_effect(component, repair, has_helped);
    };
    runtime.on_events = [&](std::span<const Event> events) {
      note_events(events, manager.knowledge(), robot.plant());
      take_beliefs(manager.knowledge(), result);
      take_couplings(manager.knowledge(), result);
    };
    runtime.run(robot.is_over(), Time(from_seconds(scenario_.horizon_s)));
  }

  void tell(LearningResult& result) const {
    const Beliefs initial(rules_);
    for (std::size_t s = 0; s < beliefs_.size(); ++s) {
      const Strategy& strategy = rules_.strategies[s];
      const Belief before = initial[StrategyId(s)];
      result.strategies.push_back(
          {rules_[strategy.components.front()].name + "." + strategy.name, before.mean().value,
           truths_[s].executed, truths_[s].helped, beliefs_[s].mean().value,
           beliefs_[s].alpha + beliefs_[s].beta - before.alpha - before.beta, truths_[s].judged,
           truths_[s].judged_helped});
    }
    for (const auto& [pair, truth] : coupled_) {
      const auto found = couplings_.find(pair);
      const Coupling learned = found == couplings_.end() ? Coupling() : found->second;
      result.couplings.push_back({rules_[pair.first].name, rules_[pair.second].name, truth.first,
                                  truth.second, learned.cleared + learned.stayed, learned.cleared});
    }
  }

 private:
  // The truth about one strategy (learning.h).
  struct Truth {
    int executed = 0;
    int helped = 0;
    int judged = 0;
    int judged_helped = 0;
    bool has_last_helped = false;
    std::deque<std::pair<Time, bool>> pending;  // when the verdict counts: did it help?
  };

  // Long enough for a fault that shows now and then, and for each outcome to count before the end.
  static constexpr Duration kHealthy = std::chrono::seconds(3);
  static constexpr Duration kQuiet = std::chrono::seconds(12);

  std::unique_ptr<const Planner> planner() const {
    if (campaign_.uses_paper_planner) return std::make_unique<PaperPlanner>();
    return std::make_unique<BayesPlanner>(campaign_.objective);
  }

  void believe(Priors priors) {
    if (priors == Priors::kRight) return;
    double factor = 1.2;
    for (Strategy& strategy : rules_.strategies) {
      const bool is_flat = priors == Priors::kFlat;
      strategy.success.value = is_flat ? 0.5 : std::min(1.0, factor * strategy.success.value);
      if (is_flat) strategy.confidence = 2;
      factor = factor > 1 ? 0.8 : 1.2;
    }
  }

  // Component i has rule i, and a rule's strategies are called as the repairs are.
  void note_effect(std::size_t component, Repair repair, bool has_helped) {
    if (!has_helped) return;
    for (const StrategyId id : rules_.rules[component].strategies) {
      if (rules_[id].name != to_string(repair)) continue;
      ++truths_[id.index].helped;
      truths_[id.index].has_last_helped = true;
    }
  }

  void note_events(std::span<const Event> events, const Knowledge& knowledge, const Plant& plant) {
    for (const Event& event : events) {
      if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
        ++truths_[chosen->strategy.index].executed;
        truths_[chosen->strategy.index].has_last_helped = false;
        early_.erase(rules_[chosen->strategy].rule);
      }
      note_outcome(event);
      const auto* resolved = std::get_if<FailureResolved>(&event.what);
      if (resolved == nullptr) continue;
      if (!resolved->strategy) {
        note_early(resolved->rule, knowledge, plant);
        continue;
      }
      if (plant.fault(resolved->rule.index)) continue;
      for (const RuleId effect : early_[resolved->rule]) {
        auto& [asked, cleared] = coupled_[{resolved->rule, effect}];
        ++asked;
        ++cleared;
      }
      early_.erase(resolved->rule);
      for (const RuleId effect : there_until(events, knowledge)) {
        const RuleState& state = knowledge.states[effect];
        if (effect == resolved->rule || state.attempt ||
            !plant.passes(resolved->rule.index, effect.index))
          continue;
        // Kappa is defined for a cause that is alone (diagnose/diagnosis.h). A component without a
        // fault of its own is in a chain from it, or recovers by itself.
        const auto& active = knowledge.states.active();
        const bool is_alone = std::none_of(active.begin(), active.end(), [&](RuleId other) {
          return other != effect && other != resolved->rule &&
                 plant.passes(other.index, effect.index) &&
                 (plant.fault(other.index) || knowledge.states[other].attempt);
        });
        if (!is_alone) continue;
        const bool stays = plant.fault(effect.index).has_value();
        auto& [asked, cleared] = coupled_[{resolved->rule, effect}];
        ++asked;
        cleared += stays ? 0 : 1;
      }
    }
  }

  // The failures that are active after these events, and those that cleared by themselves with
  // them, thus with their cause.
  static std::vector<RuleId> there_until(std::span<const Event> events,
                                         const Knowledge& knowledge) {
    std::vector<RuleId> there = knowledge.states.active();
    for (const Event& event : events) {
      const auto* resolved = std::get_if<FailureResolved>(&event.what);
      if (resolved != nullptr && !resolved->strategy) there.push_back(resolved->rule);
    }
    return there;
  }

  // A verdict is of the last execution, and says when it will count; one that never will counts, as
  // nothing, at once.
  void note_outcome(const Event& event) {
    if (const auto* judged = std::get_if<OutcomePending>(&event.what)) {
      Truth& truth = truths_[judged->strategy.index];
      truth.pending.emplace_back(judged->due, truth.has_last_helped);
    }
    const auto* counted = std::get_if<OutcomeCounted>(&event.what);
    if (counted == nullptr) return;
    Truth& truth = truths_[counted->strategy.index];
    if (truth.pending.empty() || event.at < truth.pending.front().first) return;
    if (counted->as != OutcomeCounted::As::kNothing) {
      ++truth.judged;
      truth.judged_helped += truth.pending.front().second ? 1 : 0;
    }
    truth.pending.pop_front();
  }

  // Some failures show it before their cause does that it was repaired.
  void note_early(RuleId effect, const Knowledge& knowledge, const Plant& plant) {
    for (const RuleId cause : knowledge.states.active()) {
      const auto& attempt = knowledge.states[cause].attempt;
      if (attempt && attempt->first_change != kNever && plant.passes(cause.index, effect.index))
        early_[cause].push_back(effect);
    }
  }

  // Was this count, among those that fade, raised by an outcome?
  bool is_raised(double now, double before) const {
    return now > campaign_.forgetting * before + 0.5;
  }

  void take_beliefs(const Knowledge& knowledge, LearningResult* result) {
    for (std::size_t s = 0; s < beliefs_.size(); ++s) {
      const Belief now = knowledge.beliefs[StrategyId(s)];
      const Belief before = std::exchange(beliefs_[s], now);
      if (now == before || result == nullptr) continue;
      const bool has_helped = is_raised(now.alpha, before.alpha);
      result->success.add(before.mean().value, has_helped);
      result->rates.add(s, before.mean().value, has_helped);
    }
  }

  void take_couplings(const Knowledge& knowledge, LearningResult* result) {
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
      const RuleId effect(r);
      for (const auto& [cause, now] : knowledge.couplings.of(effect)) {
        const Coupling before = std::exchange(couplings_[{cause, effect}], now);
        if (now == before || result == nullptr) continue;
        const auto& upstream = knowledge.graph.upstream(rules_[effect].components.front());
        const bool depends = std::find(upstream.begin(), upstream.end(),
                                       rules_[cause].components.front()) != upstream.end();
        result->kappa.add(before.mean(depends ? Coupling::kUsual : Coupling::kRare),
                          is_raised(now.cleared, before.cleared));
      }
    }
  }

  const LearningCampaign& campaign_;
  RcaScenario scenario_;
  RuleSet rules_;
  std::vector<Belief> beliefs_;
  std::vector<Truth> truths_;                    // by strategy
  std::map<RuleId, std::vector<RuleId>> early_;  // by cause: effects that were gone before it
  std::map<std::pair<RuleId, RuleId>, std::pair<int, int>> coupled_;  // asked, cleared
  std::map<std::pair<RuleId, RuleId>, Coupling> couplings_;           // by cause and effect
};

}  // namespace

std::optional<LearningResult> learn(const LearningCampaign& campaign,
                                    const std::function<bool()>& is_stopped) {
  Learner learner(campaign);
  LearningResult result;
  result.rates = Calibration(learner.strategies());
  const auto each = static_cast<std::uint32_t>(std::max<std::size_t>(1, campaign.setting.faults));
  bool has_drifted = !campaign.has_drift;
  for (std::uint64_t episode = 0; result.measured < campaign.measured(); ++episode) {
    if (is_stopped && is_stopped()) return std::nullopt;
    if (!has_drifted && 4 * result.learned >= 3 * campaign.faults) {
      learner.drift();
      has_drifted = true;
    }
    const bool is_measured = result.learned >= campaign.faults;
    learner.play(simulation::mix(simulation::mix(campaign.seed) + episode),
                 is_measured ? &result : nullptr);
    (is_measured ? result.measured : result.learned) += each;
  }
  learner.tell(result);
  return result;
}

}  // namespace culprit::study::rca
