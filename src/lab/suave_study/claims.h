// Every claim of the paper's evaluation on SUAVE that its runs can test, judged on ours.
//
// Two means are alike if they differ by less than the margin of --validate, half the published
// standard deviation (of that row); chosen before these tests, with the old tables known. Shares of
// left-out runs are alike if they differ by less than 0.1.
#pragma once

#include "study/claim.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"

namespace culprit::study {

// Judged. @pre both have all managers of the paper's table, and are of these missions
std::vector<Claim> suave_claims(const SuaveResult& standard, const SuaveResult& extended);

Table suave_claims_table(const SuaveResult& standard, const SuaveResult& extended);

}  // namespace culprit::study
