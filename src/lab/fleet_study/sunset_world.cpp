#include <cmath>

#include "fleet_study/worlds.h"
#include "simulation/random.h"
#include "sunset_study/learning_run.h"
#include "sunset_study/study.h"

namespace culprit::study::fleet {
namespace {

constexpr double kDifference = 0.5;  // of robots of one model: e to the power of a normal deviate

class SunsetRobot : public FleetRobot {
 public:
  SunsetRobot(const LearningRuns& runs, std::vector<double> weights, std::uint64_t luck)
      : runs_(runs), weights_(std::move(weights)), luck_(luck) {}

  Episode live_through(std::vector<Belief>& beliefs) override {
    const SunsetRun run = runs_.play(sunset::scenarios()[drawn()], luck_.next(), beliefs);
    Episode episode;
    for (const Event& event : run.events) {
      episode.failures += std::holds_alternative<FailureDetected>(event.what) ? 1 : 0;
      episode.failed += std::holds_alternative<StrategyFailed>(event.what) ? 1 : 0;
    }
    return episode;
  }

 private:
  std::size_t drawn() {
    double sum = 0;
    for (const double weight : weights_) sum += weight;
    double place = luck_.uniform(0, sum);
    for (std::size_t i = 0; i + 1 < weights_.size(); ++i) {
      place -= weights_[i];
      if (place < 0) return i;
    }
    return weights_.size() - 1;
  }

  const LearningRuns& runs_;
  std::vector<double> weights_;  // of the scenarios
  simulation::Random luck_;
};

class SunsetWorld : public FleetWorld {
 public:
  SunsetWorld(SunsetStudy study, Probabilities guesses)
      : study_(std::move(study)), guesses_(guesses), runs_(study_.learning_runs()) {}

  std::string name() const override {
    return guesses_ == Probabilities::kIdeal ? "SUNSET, the paper's guesses"
                                             : "SUNSET, guesses 20 % off";
  }
  std::vector<Belief> guesses(std::uint64_t /*model*/) const override {
    std::vector<Belief> all;
    for (const Strategy& strategy : runs_.rules().strategies)
      all.push_back(initial_belief(strategy.success, strategy.confidence));
    return all;
  }
  std::unique_ptr<FleetRobot> robot(std::uint64_t model, std::uint64_t number,
                                    std::uint64_t life) const override {
    simulation::Random of_model(simulation::mix(model));
    simulation::Random of_robot(simulation::mix(model ^ simulation::mix(number)));
    std::vector<double> weights;
    for (std::size_t i = 0; i < sunset::scenarios().size(); ++i)
      weights.push_back(-std::log(1 - of_model.uniform()) *
                        std::exp(kDifference * of_robot.normal()));
    return std::make_unique<SunsetRobot>(runs_, std::move(weights),
                                         simulation::mix(of_robot.next() + life));
  }

 private:
  SunsetStudy study_;
  Probabilities guesses_;
  LearningRuns runs_;
};

}  // namespace

Expected<std::unique_ptr<FleetWorld>> sunset_world(const std::string& profile,
                                                   Probabilities guesses) {
  auto study = SunsetStudy::make({{{}, "bayes", profile, guesses}}, 1);
  if (!study) return Error{study.error()};
  return std::unique_ptr<FleetWorld>(std::make_unique<SunsetWorld>(std::move(*study), guesses));
}

}  // namespace culprit::study::fleet
