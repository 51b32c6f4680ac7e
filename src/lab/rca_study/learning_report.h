// How true what was learned is: as text and JSON.
//
//     {"campaign": {"command": "culprit study rca --learn ...", "version": "0.1.0"},
//      "learning": {"components": 10, "faults": 1, "faults_learned": 500, "faults_measured": 2000,
//                   "forgetting": 1, "drift": false,
//                   "success": {"expected_calibration_error": 0.02, "outcomes": 2600,
//                               "bins": [{"forecast": 0.05, "came_true": 0.06, "count": 120}]},
//                   "kappa": ..., "rate_error": 0.02}}
//
// rate_error is the mean distance of what was believed of a strategy from how often it helped.
// Bins without a forecast are left out.
#pragma once

#include <string>

#include "rca_study/learning.h"

namespace culprit::study::rca {

std::string learning_text(const LearningCampaign& campaign, const LearningResult& result);
// `command` makes it again.
std::string learning_json(const LearningCampaign& campaign, const LearningResult& result,
                          const std::string& command, const std::string& version);

}  // namespace culprit::study::rca
