// The tables of a study. Means are "mean ± sd" with two decimals and the population's deviation, as
// the paper prints them.
#pragma once

#include <vector>

#include "study/comparison.h"
#include "study/findings.h"
#include "study/tables/table.h"

namespace culprit::study {

// The paper's metrics of each row, the best mean of each in bold (tab:ablation-study).
Table results_table(const CampaignResult& result);

// The honest metrics of each row but those of the next table, with the 95 % interval of each mean.
Table honest_table(const CampaignResult& result);

// How often the root causes were found, with the 95 % interval of each mean.
Table root_cause_table(const CampaignResult& result);

// Each mean of an ablation beside the paper's, and whether it lies within the paper's mean ± 1 sd.
Table comparison_table(const Ablation& ablation);

// Each effect beside the paper's (tab:ablation-study-eval).
Table effects_table(const Ablation& ablation);

// Each row that was played on the live robot, beside the same on its model, and Welch's test of the
// differences. @pre there is such a pair
Table live_table(const CampaignResult& result);

// Ideal beside misspecified probabilities, ours and the paper's (tab:robustness test), and Welch's
// test of the difference. @pre both are of one planner and profile
Table robustness_table(const Row& ideal, const Row& misspecified);

// The learned rates beside the true ones. @pre !curves.empty()
Table learning_table(const std::vector<LearningCurve>& curves);

// Whichever of these can be made, in this order.
std::vector<Table> tables(const Findings& findings);

}  // namespace culprit::study
