#include "sunset_study/learning_run.h"

#include <algorithm>

#include "study/published.h"

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

// The period of the bag's pictures.
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

// The fusion passes on old pictures first. A camera that does not focus has a second of pictures
// waiting, and the blackboard, which is published at its period, has the last of them. A strategy that is judged before the robot can show its effect loses its success: it is undone, and
// the next one gets the credit.
void wait_for_effects(RuleSet& rules, const sunset::model::Profile& profile) {
  const Duration queue = std::chrono::seconds(1) + 2 * profile.blackboard_period;
  const Duration pictures = kFramePeriod * static_cast<std::int64_t>(profile.fusion_keeps);
  for (Strategy& strategy : rules.strategies) {
    const std::string& rule = rules[strategy.rule].name;
    const Duration lag = rule == "SegmentationBad"   ? pictures
                         : rule == "AutoFocusNeeded" ? queue
                                                     : Duration::zero();
    strategy.impact = std::max(strategy.impact, Cycles{lag / rules.cycle + 1});
    rules.heaviest = std::max(rules.heaviest, strategy.impact);
  }
}

}  // namespace

LearningRuns::LearningRuns(const RuleSet& rules, const sunset::model::Profile& profile,
                           MakePlanner planner, Manager::Options options)
    : profile_(to_learn_from(profile)), planner_(std::move(planner)), options_(std::move(options)) {
  RuleSet learned = rules;
  for (Strategy& strategy : learned.strategies)
    strategy.confidence = published::kLearning.confidence;
  wait_for_effects(learned, profile_);
  rules_ = std::make_unique<const RuleSet>(std::move(learned));
  options_.governor.limits.backoff.healthy = proof(profile_);
}

SunsetRun LearningRuns::play(const sunset::Scenario& scenario, std::uint64_t seed,
                             std::vector<Belief>& beliefs) const {
  sunset::model::SunsetModel model(profile_, seed);
  Manager manager(*rules_, planner_(), options_);
  for (std::size_t s = 0; s < beliefs.size(); ++s) manager.set_belief(StrategyId(s), beliefs[s]);
  SunsetRun run = study::play(model, *rules_, manager, scenario);
  for (std::size_t s = 0; s < beliefs.size(); ++s)
    beliefs[s] = manager.knowledge().beliefs[StrategyId(s)];
  return run;
}

}  // namespace culprit::study
