// One run of the SUNSET study: the model is broken by a scenario, and managed.
#pragma once

#include <span>
#include <vector>

#include "exemplars/sunset/model/sunset_model.h"
#include "manager/managing_system.h"
#include "study/run_metrics.h"

namespace culprit::study {

// The parts of a run that metrics need.
struct SunsetRun {
  sunset::Scenario scenario;
  Time begin;                                                     // of managing
  std::vector<sunset::model::SunsetModel::Injection> injections;  // by time
  Time end;
  std::vector<Event> events;

  // How good a choice was, known from the faults that were there when it was made.
  struct Choice {
    StrategyId strategy;
    bool is_right_place = false;  // it adapts only components where a fault can be repaired
    bool is_remedy = false;       // it ends a fault
  };
  std::vector<Choice> choices;  // of each StrategyChosen in `events`, in their order

  Duration downtime{};         // as the exemplar counts it (sunset/downtime.h)
  Duration honest_downtime{};  // with what is missing at the begin and at the end
  Duration recovery{};         // from the first fault until the robot was well for good
  bool is_recovered = false;   // otherwise `recovery` lasts until the end
};

// How good it is to choose `strategy` while these faults are there.
SunsetRun::Choice judge(StrategyId strategy, const RuleSet& rules,
                        std::span<const sunset::Fault* const> present);

// Lets `manager`, which works by `rules`, manage `model` from the profile's start of managing to
// the end of the run.
SunsetRun play(sunset::model::SunsetModel& model, const RuleSet& rules, ManagingSystem& manager,
               const sunset::Scenario& scenario);

// `has_d_alone`: the configuration considers dependencies and nothing else, whose runs the
// exemplar's script treats in a way of its own.
RunMetrics measure(const SunsetRun& run, const RuleSet& rules, bool has_d_alone);

}  // namespace culprit::study
