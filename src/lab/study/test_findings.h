// Findings of no robot, for tests of what is made of findings: drawn around the paper's means.
#pragma once

#include "study/findings.h"

namespace culprit::study {

// The eight configurations of the ablation and the one with misspecified probabilities.
Campaign synthetic_campaign(std::uint32_t runs);

// Made up for a run; depends on its arguments only.
RunMetrics synthetic_run(const Configuration& configuration, RunId id);

CampaignResult synthetic_result(std::uint32_t runs);

// Also with curves and timelines.
Findings synthetic_findings(std::uint32_t runs);

}  // namespace culprit::study
