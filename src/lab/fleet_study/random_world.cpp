#include <algorithm>

#include "fleet_study/worlds.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "rca_study/rca_robot.h"
#include "rca_study/rules.h"
#include "simulation/random.h"

namespace culprit::study::fleet {
namespace {

using rca::RcaScenario;

constexpr rca::RcaSetting kSetting{5, 1, 0, false};
constexpr double kPrecision = 20;  // of a robot's rate around its model's
// As in the study of learning (rca_study/learning.cpp).
constexpr Duration kHealthyAfter = std::chrono::seconds(3);
constexpr Duration kQuietAtEnd = std::chrono::seconds(12);

// One graph for all models, so that they have the same strategies; what helps is each model's own.
constexpr std::uint64_t kGraph = 1;

RcaScenario model_of(std::uint64_t model) {
  RcaScenario scenario = generate(kSetting, simulation::mix(kGraph));
  const RcaScenario other = generate(kSetting, simulation::mix(model));
  for (std::size_t c = 0; c < scenario.components.size(); ++c) {
    for (auto& treatment : scenario.components[c].treatments) {
      for (const auto& its : other.components[c].treatments) {
        if (its.repair == treatment.repair) treatment.helps = its.helps;
      }
    }
  }
  return scenario;
}

void guess(RuleSet& rules, rca::Priors guesses) {
  double factor = 1.2;
  for (Strategy& strategy : rules.strategies) {
    if (guesses == rca::Priors::kFlat) {
      strategy.success.value = 0.5;
      strategy.confidence = 2;
    } else if (guesses == rca::Priors::kOff) {
      strategy.success.value = std::min(1.0, factor * strategy.success.value);
      factor = factor > 1 ? 0.8 : 1.2;
    }
  }
}

class RandomRobot : public FleetRobot {
 public:
  RandomRobot(RcaScenario scenario, const RuleSet& rules, std::uint64_t luck)
      : scenario_(std::move(scenario)), rules_(rules), luck_(luck) {}

  Episode live_through(std::vector<Belief>& beliefs) override {
    scenario_.seed = luck_.next();
    scenario_.faults = random_faults(kSetting, luck_.next());
    rca::RcaRobot robot(scenario_, rules_, kQuietAtEnd);
    Manager::Options options;
    options.discovery = Duration::zero();
    options.governor.limits.backoff.healthy = kHealthyAfter;
    Manager manager(rules_, std::make_unique<BayesPlanner>(Objective::kBalanced), options);
    for (std::size_t s = 0; s < beliefs.size(); ++s) manager.set_belief(StrategyId(s), beliefs[s]);
    Runtime runtime(manager, robot);
    Episode episode;
    runtime.on_events = [&](std::span<const Event> events) {
      for (const Event& event : events) {
        episode.failures += std::holds_alternative<FailureDetected>(event.what) ? 1 : 0;
        episode.failed += std::holds_alternative<StrategyFailed>(event.what) ? 1 : 0;
      }
    };
    runtime.run(robot.is_over(), Time(from_seconds(scenario_.horizon_s)));
    for (std::size_t s = 0; s < beliefs.size(); ++s)
      beliefs[s] = manager.knowledge().beliefs[StrategyId(s)];
    return episode;
  }

 private:
  RcaScenario scenario_;
  const RuleSet& rules_;
  simulation::Random luck_;
};

class RandomWorld : public FleetWorld {
 public:
  explicit RandomWorld(rca::Priors guesses)
      : guesses_(guesses), rules_(rca::rules_of(model_of(kGraph))) {
    guess(rules_, guesses);
  }

  std::string name() const override {
    switch (guesses_) {
      case rca::Priors::kOff:
        return "random, guesses 20 % off";
      case rca::Priors::kFlat:
        return "random, no guesses (50 %)";
      case rca::Priors::kRight:
        break;
    }
    return "random, guesses of the benchmark";
  }
  std::vector<Belief> guesses(std::uint64_t /*model*/) const override {
    std::vector<Belief> all;
    for (const Strategy& strategy : rules_.strategies)
      all.push_back(initial_belief(strategy.success, strategy.confidence));
    return all;
  }
  std::unique_ptr<FleetRobot> robot(std::uint64_t model, std::uint64_t number,
                                    std::uint64_t life) const override {
    RcaScenario scenario = model_of(model);
    simulation::Random rates(simulation::mix(model ^ simulation::mix(number)));
    for (auto& component : scenario.components) {
      for (auto& treatment : component.treatments) {
        for (double& helps : treatment.helps)
          helps = draw_rate(helps, kPrecision, [&] { return rates.uniform(); });
      }
    }
    return std::make_unique<RandomRobot>(std::move(scenario), rules_,
                                         simulation::mix(rates.next() + life));
  }

 private:
  rca::Priors guesses_;
  RuleSet rules_;
};

}  // namespace

std::unique_ptr<FleetWorld> random_world(rca::Priors guesses) {
  return std::make_unique<RandomWorld>(guesses);
}

}  // namespace culprit::study::fleet
