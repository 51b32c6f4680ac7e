// The SUNSET study: which rules, which manager and which fault combination each run of a campaign
// has.
//
// A run depends on nothing but its configuration, its number and the campaign's seed. Runs of one
// number play the same scenario in every configuration; everything that is left to chance is drawn
// anew in each, so that configurations are independent groups, as the statistics take them to be.
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "language/rule_set.h"
#include "manager/manager.h"
#include "managers/bandit_manager.h"
#include "study/campaign.h"
#include "study/learning.h"
#include "study/single_run.h"
#include "study/timeline.h"
#include "sunset_study/learning_run.h"
#include "sunset_study/run.h"
#include "sunset_study/variation.h"

namespace culprit::study {

class SunsetStudy {
 public:
  // Errors: an unknown planner or profile; a planner that cannot watch a profile (the reference
  // needs a blackboard), or cannot play the live robot (the oracle needs a model's truth); rules of
  // the variation that have errors. A profile may name its detectors (detectors.h).
  static Expected<SunsetStudy> make(std::vector<Configuration> rows, std::uint64_t seed,
                                    const Variation& variation = {});

  // From several threads if you like. @pre the row is not of profile kLiveRobot
  RunMetrics run(RunId id) const;

  // The same run, with all that happened in it. By the rules of its row.
  SunsetRun play(RunId id) const;
  const RuleSet& rules(std::uint32_t row) const { return *settings_[row].rules; }

  // The parts of a run, for callers that play it elsewhere than on the model.
  const sunset::model::Profile& profile(std::uint32_t row) const { return *settings_[row].profile; }
  static const sunset::Scenario& scenario_of(RunId id);
  std::uint64_t seed_of(RunId id) const;
  std::unique_ptr<ManagingSystem> manager(RunId id, const Manager::Options& options) const;
  // The metrics of such a run.
  RunMetrics measured(RunId id, const SunsetRun& run) const;

  // The same run, to look at moment by moment; and told in sentences.
  SingleRun single_run(RunId id) const;
  Timeline explain(RunId id) const;

  // Runs of row 0 that are learned from. They refer to nothing of the study.
  LearningRuns learning_runs() const;

  // `experiments` runs after each other with beliefs that are carried on, `repetitions` times: what
  // row 0, of culprit's own planners, learns. A curve for each strategy of the paper's failures F1
  // to F5.
  // `told` is called with the number of finished ones (null: never).
  std::vector<LearningCurve> learn(std::uint32_t experiments, std::uint32_t repetitions,
                                   const std::function<void(std::uint64_t done)>& told) const;

 private:
  // The part that all runs of a row share.
  struct Setting {
    Configuration configuration;
    std::unique_ptr<const sunset::model::Profile> profile;
    std::unique_ptr<const RuleSet> rules;  // managers keep its address
    BanditExperience experience;           // of a bandit, that each run begins with
  };

  SunsetStudy(std::vector<Setting> settings, std::uint64_t seed)
      : settings_(std::move(settings)), seed_(seed) {}

  // A bandit learns from as many experiments as the paper's learning has, with seeds of their own.
  void train(Setting& setting) const;

  static Manager::Options manager_options(const sunset::model::Profile& profile);
  // For all planners but "reference".
  static std::unique_ptr<const Planner> planner_of(const Configuration& configuration);

  std::vector<Setting> settings_;
  std::uint64_t seed_;
};

// The existing planners: "paper", "reference", "bayes" (balanced), and "bayes:downtime" and so on
// with another objective. Then the managers of others, "bt", "metacontrol", "rosa", "rebet",
// "rebet-ucb", "rebet-greedy", "rebet-random", "ac-ros", "vogel" and "ghahremani"; "bandit" and
// "random". Last, "oracle", which knows each fault, and its remedy, at once.
std::vector<std::string_view> sunset_planners();

// Whether a planner has the paper's D, C and S to switch off.
bool has_switches(std::string_view planner);

// Whether it is one whose success probabilities are learned: culprit's own.
bool can_learn(std::string_view planner);

}  // namespace culprit::study
