// What a manager learns from one experiment after the other (paper, "Learning mechanism").
#include <algorithm>

#include "manager/manager.h"
#include "study/published.h"
#include "sunset_study/study.h"

namespace culprit::study {
namespace {

// How long an outcome has to stand until it is learned from. The tables of the study judge at once,
// as the paper does; but SUNSET's own monitoring shows an outage late, and until then every strategy
// for a bad picture seems not to help: a topic is slow once its last pictures, a window of them, came
// in at less than one each second.
Duration proof(const sunset::model::Profile& profile) {
  constexpr Duration kEach = std::chrono::seconds(1);
  return (static_cast<std::int64_t>(profile.frequency_window) + 1) * kEach;
}

// Of the bag's pictures.
constexpr Duration kFramePeriod = std::chrono::milliseconds(100);

// A run that is learned from begins shortly before its faults. The managers of the profiles `head`
// and `october` begin before the blackboard has counted as many pictures as it wants to: it says
// that all is silent, and whatever is restarted then seems to help. It lasts longer than one of the
// tables: a second repair comes later than an outage is shown, and each outcome has to stand.
sunset::model::Profile to_learn_from(sunset::model::Profile profile) {
  profile.manager_start = profile.injection.least - profile.blackboard_period;
  profile.end_of_run += 3 * proof(profile);
  return profile;
}

// The fusion passes on old pictures first. Whoever judges before what it keeps has gone by takes
// what helped for a failure, undoes it, and thanks the next strategy.
void wait_for_pictures(RuleSet& rules, const sunset::model::Profile& profile) {
  const Duration lag = kFramePeriod * static_cast<std::int64_t>(profile.fusion_keeps);
  const Cycles cycles{lag / rules.cycle + 1};
  for (Strategy& strategy : rules.strategies) {
    if (rules[strategy.rule].name == "SegmentationBad")
      strategy.impact = std::max(strategy.impact, cycles);
    rules.heaviest = std::max(rules.heaviest, strategy.impact);
  }
}

struct Learner {
  StrategyId strategy;
  LearningCurve curve;
  // Of each execution, and of each that was learned from: is the fault one that it ends?
  Moments remedies;
  Moments learned_remedies;

  void note(const SunsetRun& run, const RuleSet& rules);
};

// A strategy that had ended the fault already, and is executed again since an
// outage hides that, is still the one that this failure needs.
void Learner::note(const SunsetRun& run, const RuleSet& rules) {
  const double is_remedy = judge(strategy, rules, run.scenario.faults).is_remedy ? 1 : 0;
  for (const Event& event : run.events) {
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      if (chosen->strategy == strategy) remedies.add(is_remedy);
    } else if (const auto* counted = std::get_if<OutcomeCounted>(&event.what)) {
      if (counted->strategy == strategy && counted->as != OutcomeCounted::As::kNothing)
        learned_remedies.add(is_remedy);
    }
  }
}

// The paper's name of the failure; empty: no fault of SUNSET causes it.
std::string failure_of(const std::string& rule) {
  if (rule == "RGBDead") return "F1";
  if (rule == "SensorFusionDead") return "F2";
  if (rule == "SegmentationDead") return "F3";
  if (rule == "SegmentationBad") return "F4";
  if (rule == "AutoFocusNeeded") return "F5";
  return "";
}

std::vector<Learner> learners(const RuleSet& rules, std::uint32_t experiments) {
  std::vector<Learner> all;
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    const Strategy& strategy = rules.strategies[s];
    const std::string& rule = rules[strategy.rule].name;
    const std::string failure = failure_of(rule);
    if (failure.empty()) continue;
    Learner learner;
    learner.strategy = StrategyId(s);
    learner.curve = {failure, rule, strategy.name, strategy.success.value, 0, {}, 0, 0, 0};
    learner.curve.learned.resize(experiments);
    learner.curve.confidence = strategy.confidence;
    all.push_back(std::move(learner));
  }
  return all;
}

}  // namespace

std::vector<LearningCurve> SunsetStudy::learn(
    std::uint32_t experiments, std::uint32_t repetitions,
    const std::function<void(std::uint64_t)>& told) const {
  const Setting& setting = settings_.front();
  RuleSet rules = *setting.rules;
  for (Strategy& strategy : rules.strategies) strategy.confidence = published::kLearning.confidence;
  const sunset::model::Profile profile = to_learn_from(*setting.profile);
  wait_for_pictures(rules, profile);
  const std::vector<sunset::Scenario> scenarios = sunset::scenarios();
  std::vector<Learner> all = learners(rules, experiments);
  const Beliefs initial(rules);
  for (std::uint32_t repetition = 0; repetition < repetitions; ++repetition) {
    Beliefs beliefs = initial;
    simulation::Random order(seed_of({repetition, experiments}));
    for (std::uint32_t experiment = 0; experiment < experiments; ++experiment) {
      const std::uint64_t seed = seed_of({repetition, experiment});
      sunset::model::SunsetModel model(profile, seed);
      Manager::Options options = manager_options(profile);
      options.governor.limits.backoff.healthy = proof(profile);
      Manager manager(rules, planner_of(setting.configuration), options);
      for (std::size_t s = 0; s < rules.strategies.size(); ++s)
        manager.set_belief(StrategyId(s), beliefs[StrategyId(s)]);
      const auto scenario =
          static_cast<std::size_t>(order.below(static_cast<int>(scenarios.size())));
      const SunsetRun run = study::play(model, rules, manager, scenarios[scenario]);
      beliefs = manager.knowledge().beliefs;
      if (told) told(std::uint64_t{repetition} * experiments + experiment + 1);
      for (Learner& learner : all) {
        learner.curve.learned[experiment].add(beliefs[learner.strategy].mean().value);
        learner.note(run, rules);
      }
    }
    for (Learner& learner : all) {
      const Belief now = beliefs[learner.strategy];
      const Belief before = initial[learner.strategy];
      learner.curve.counted +=
          (now.alpha + now.beta - before.alpha - before.beta) / std::max(1U, repetitions);
    }
  }
  std::vector<LearningCurve> curves;
  for (Learner& learner : all) {
    LearningCurve& curve = learner.curve;
    const Moments& executed = learner.remedies;
    const Moments& judged = learner.learned_remedies;
    curve.truth_of_all = executed.count() > 0 ? executed.mean() : 0;
    curve.truth = judged.count() > 0 ? judged.mean() : curve.truth_of_all;
    curve.executed = static_cast<double>(executed.count()) / std::max(1U, repetitions);
    curves.push_back(std::move(learner.curve));
  }
  return curves;
}

}  // namespace culprit::study
