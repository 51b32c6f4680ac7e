// Findings as CSV (RFC 4180, but with plain line ends), one fact a line, full precision, for R or
// pandas. A number that does not exist is an empty field.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/claim.h"
#include "study/comparison.h"
#include "study/findings.h"

namespace culprit::study {

// A line for each metric of each row:
// dependencies,criticality,impact,planner,profile,probabilities,runs,metric,count,mean,sd,independent,
// ci_low,ci_high,censored,published_mean,published_sd,is_within
std::string metrics_csv(const CampaignResult& result);

// A line for each metric of each effect:
// planner,profile,metric,from,to,difference,ci_low,ci_high,p,percent,verdict,published_percent,
// published_verdict,same_sign       (from, to: "D-S"; verdict: better, worse, none)
std::string effects_csv(const CampaignResult& result);

// A line for each value that occurs in a metric of a row, with how often it does (to a small
// relative error where more than Distribution::kMostValues different ones occur). Lower bounds are
// left out: dependencies,criticality,impact,planner,profile,probabilities,metric,value,count
std::string values_csv(const CampaignResult& result);

// A line for each part of each claim, with what was compared, so that others can test it again
// (studies/check_claims.py): planner,profile,claim,test,comparison,first,first_mean,first_sd,first_count,
// second,second_mean,second_sd,second_count,bound,margin,part_p,part_p_against,p,p_against,verdict
// (comparison: more, alike, above, below, near; of one sample the second is empty)
std::string claims_csv(const Findings& findings);
std::string claims_csv(std::string_view planner, std::string_view profile,
                       const std::vector<Claim>& claims);

}  // namespace culprit::study
