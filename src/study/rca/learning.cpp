#include "study/rca/learning.h"

#include <algorithm>
#include <map>
#include <utility>

#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/random.h"
#include "study/rca/rca_robot.h"
#include "study/rca/rules.h"

namespace culprit::study::rca {
namespace {

class Learner {
 public:
  explicit Learner(const LearningCampaign& campaign)
      : campaign_(campaign),
        scenario_(generate(campaign.setting, simulation::mix(campaign.seed))),
        rules_(rules_of(scenario_)) {
    const Beliefs initial(rules_);
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
    scenario_.faults = random_faults(campaign_.setting, simulation::mix(seed));
    RcaRobot robot(scenario_, rules_);
    Manager::Options options;
    options.settling = Duration::zero();
    options.forgetting = campaign_.forgetting;
    Manager manager(rules_, std::make_unique<BayesPlanner>(campaign_.objective), options);
    for (std::size_t s = 0; s < beliefs_.size(); ++s)
      manager.set_belief(StrategyId(s), beliefs_[s]);
    for (const auto& [pair, coupling] : couplings_)
      manager.set_coupling(pair.first, pair.second, coupling);
    Runtime runtime(manager, robot);
    runtime.on_events = [&](std::span<const Event>) {
      take_beliefs(manager.knowledge(), result);
      take_couplings(manager.knowledge(), result);
    };
    runtime.run(robot.is_over(), Time(from_seconds(scenario_.horizon_s)));
  }

 private:
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
  std::map<std::pair<RuleId, RuleId>, Coupling> couplings_;  // by cause and effect
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
  return result;
}

}  // namespace culprit::study::rca
