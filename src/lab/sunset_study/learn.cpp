// A manager that learns from one experiment after the other (paper, "Learning mechanism").
#include <algorithm>

#include "sunset_study/study.h"

namespace culprit::study {
namespace {

// The failures of a run, from their detection to their end.
struct FailureSpan {
  RuleId rule;
  Time begin;
  Time end = kNever;
};

std::vector<FailureSpan> failures_of(const SunsetRun& run) {
  std::vector<FailureSpan> all;
  for (const Event& event : run.events) {
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      all.push_back({detected->rule, event.at});
    const auto* resolved = std::get_if<FailureResolved>(&event.what);
    if (resolved == nullptr) continue;
    for (FailureSpan& failure : all) {
      if (failure.rule == resolved->rule && failure.end == kNever) failure.end = event.at;
    }
  }
  return all;
}

struct Learner {
  StrategyId strategy;
  LearningCurve curve;
  // For each execution, and for each that was learned from: whether it ends the fault.
  Moments remedies;
  Moments learned_remedies;
  Moments verdicts;  // for each execution: whether the failure was gone

  void note(const SunsetRun& run, const RuleSet& rules);
  // An outcome that counts for nothing.
  void note_dropped(const SunsetRun& run, const RuleSet& rules, Time verdict, Time dropped);
};

// A strategy that had ended the fault already, and is executed again since an
// outage hides that, is still the one that this failure needs.
void Learner::note(const SunsetRun& run, const RuleSet& rules) {
  const double is_remedy = judge(strategy, rules, run.scenario.faults).is_remedy ? 1 : 0;
  double open = 0;
  Time verdict{};
  for (const Event& event : run.events) {
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      if (chosen->strategy != strategy) continue;
      remedies.add(is_remedy);
      open += 1;
      verdict = event.at;
    } else if (const auto* counted = std::get_if<OutcomeCounted>(&event.what)) {
      if (counted->strategy != strategy) continue;
      open -= 1;
      if (counted->as == OutcomeCounted::As::kNothing) {
        note_dropped(run, rules, verdict, event.at);
      } else {
        learned_remedies.add(is_remedy);
      }
    } else if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
      if (failed->strategy == strategy) verdicts.add(0);
    } else if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
      if (resolved->strategy == strategy && resolved->how == FailureResolved::How::kByStrategy)
        verdicts.add(1);
    }
  }
  curve.undecided += std::max(0.0, open);
}

void Learner::note_dropped(const SunsetRun& run, const RuleSet& rules, Time verdict, Time dropped) {
  const Criticality own = rules[rules[strategy].rule].policies.criticality;
  const std::vector<FailureSpan> failures = failures_of(run);
  const bool is_hidden = std::any_of(failures.begin(), failures.end(), [&](const auto& failure) {
    return rules[failure.rule].policies.criticality > own && failure.begin <= dropped &&
           failure.end >= verdict;
  });
  (is_hidden ? curve.hidden : curve.beside) += 1;
}

// The exemplar's scenarios, and each fault alone: three times the same fault is that one. In all
// scenarios an outage begins beside the other two failures and hides, until it is repaired, what
// the strategies for these did.
std::vector<sunset::Scenario> experiments_to_learn_from() {
  std::vector<sunset::Scenario> all = sunset::scenarios();
  for (const sunset::Fault& fault : sunset::faults()) all.push_back({0, {&fault, &fault, &fault}});
  return all;
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
    learner.curve.failure = failure;
    learner.curve.rule = rule;
    learner.curve.strategy = strategy.name;
    learner.curve.initial = strategy.success.value;
    learner.curve.learned.resize(experiments);
    learner.curve.confidence = strategy.confidence;
    all.push_back(std::move(learner));
  }
  return all;
}

}  // namespace

LearningRuns SunsetStudy::learning_runs() const {
  const Setting& setting = settings_.front();
  return {*setting.rules, *setting.profile,
          [configuration = setting.configuration] { return planner_of(configuration); },
          manager_options(*setting.profile)};
}

std::vector<LearningCurve> SunsetStudy::learn(
    std::uint32_t experiments, std::uint32_t repetitions,
    const std::function<void(std::uint64_t)>& told) const {
  const LearningRuns runs = learning_runs();
  const RuleSet& rules = runs.rules();
  const std::vector<sunset::Scenario> scenarios = experiments_to_learn_from();
  std::vector<Learner> all = learners(rules, experiments);
  std::vector<Belief> initial;
  for (const Strategy& strategy : rules.strategies)
    initial.push_back(initial_belief(strategy.success, strategy.confidence));
  for (std::uint32_t repetition = 0; repetition < repetitions; ++repetition) {
    std::vector<Belief> beliefs = initial;
    simulation::Random order(seed_of({repetition, experiments}));
    for (std::uint32_t experiment = 0; experiment < experiments; ++experiment) {
      const std::uint64_t seed = seed_of({repetition, experiment});
      const auto scenario =
          static_cast<std::size_t>(order.below(static_cast<int>(scenarios.size())));
      const SunsetRun run = runs.play(scenarios[scenario], seed, beliefs);
      if (told) told(std::uint64_t{repetition} * experiments + experiment + 1);
      for (Learner& learner : all) {
        learner.curve.learned[experiment].add(beliefs[learner.strategy.index].mean().value);
        learner.note(run, rules);
      }
    }
    for (Learner& learner : all) {
      const Belief now = beliefs[learner.strategy.index];
      const Belief before = initial[learner.strategy.index];
      learner.curve.counted +=
          (now.alpha + now.beta - before.alpha - before.beta) / std::max(1U, repetitions);
    }
  }
  std::vector<LearningCurve> curves;
  for (Learner& learner : all) {
    LearningCurve& curve = learner.curve;
    curve.planner = settings_.front().configuration.planner;
    const Moments& executed = learner.remedies;
    const Moments& judged = learner.learned_remedies;
    curve.truth_of_all = executed.count() > 0 ? executed.mean() : 0;
    curve.truth = judged.count() > 0 ? judged.mean() : curve.truth_of_all;
    const double series = std::max(1U, repetitions);
    curve.executed = static_cast<double>(executed.count()) / series;
    for (double* share : {&curve.hidden, &curve.beside, &curve.undecided}) *share /= series;
    curve.verdicts = learner.verdicts.mean();
    curves.push_back(std::move(learner.curve));
  }
  return curves;
}

}  // namespace culprit::study
