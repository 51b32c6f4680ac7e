// Findings as JSON, for programs.
//
//     {"study": "sunset", "campaign": {...}, "scenarios": ["image_degradation+...", ...],
//      "rows": [{"dependencies": true, "criticality": true, "impact": true, "planner": "paper",
//                "profile": "paper", "runs": 162,
//                "ratio": {"mean": 1.01, "sd": 0.33}, "reaction_s": {...}, "downtime_s": {...},
//                "unnecessary_redeployments": {...},
//                "honest": {"downtime_s": {...}, "strategies_per_fault": {...},
//                           "wrong_component": {...}, "unresolved": {...},
//                           "recovery_s": {"mean": 4.2, "sd": 1.1, "censored": 3},
//                           "root_cause_top1": {...}, "root_cause_exact": {...},
//                           "on_front": true}}]}
//
// on_front: on the Pareto front of the honest costs (on_front() in campaign_result.h); null of what
// is no planner.
// "campaign" is as in shard files (study/run_record.h): what single runs can be played again from.
// Run i of each row plays the scenario i modulo their number.
//
// The standard deviation is the population's. Without values, mean and sd are null. A row with
// misspecified probabilities has "probabilities": "misspecified"; what was learned is in
// "learning", if anything was:
//
//     "learning": [{"failure": "F1", "rule": "RGBDead", "strategy": "redeploy", "executed": 27.4,
//                   "initial": 0.48, "truth": 0.6, "truth_of_all": 0.6,
//                   "believed": 0.55, "error": 0.05,
//                   "error_of_prior": 0.04, "standard_error": 0.1,
//                   "learned": [{"mean": 0.5, "sd": 0}, ...]}]
//
// "executed" is a mean over the series; "believed" is what the last of "learned" has.
// "error_of_prior" is what is left in it of "initial"; "standard_error" is that of one series.
#pragma once

#include <string>

#include "study/findings.h"

namespace culprit::study {

std::string json(const Findings& findings);

}  // namespace culprit::study
