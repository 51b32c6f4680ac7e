// Runs of SUNSET that are learned from, one after the other (paper, "Learning mechanism").
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "exemplars/sunset/model/sunset_model.h"
#include "language/rule_set.h"
#include "manager/manager.h"
#include "sunset_study/run.h"

namespace culprit::study {

class LearningRuns {
 public:
  using MakePlanner = std::function<std::unique_ptr<const Planner>()>;

  // `options`: of the manager, but for how long an outcome has to stand.
  LearningRuns(const RuleSet& rules, const sunset::model::Profile& profile, MakePlanner planner,
               Manager::Options options);

  // The rules with the confidence that the paper learns with.
  const RuleSet& rules() const { return *rules_; }
  // One run, which begins with `beliefs` (by strategy), and carries them on. From any thread.
  SunsetRun play(const sunset::Scenario& scenario, std::uint64_t seed,
                 std::vector<Belief>& beliefs) const;

 private:
  std::unique_ptr<const RuleSet> rules_;  // managers keep its address
  sunset::model::Profile profile_;
  MakePlanner planner_;
  Manager::Options options_;
};

}  // namespace culprit::study
