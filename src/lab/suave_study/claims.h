// Every claim of the paper's evaluation on SUAVE that its runs can test, judged on ours.
//
// Bounds, stated before any run: two means are alike if they differ by less than half of the
// paper's standard deviation of that row, and shares of left-out runs by less than 0.1.
#pragma once

#include "study/claim.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"

namespace culprit::study {

// Judged. @pre both have all managers of the paper's table, and are of these missions
std::vector<Claim> suave_claims(const SuaveResult& standard, const SuaveResult& extended);

Table suave_claims_table(const SuaveResult& standard, const SuaveResult& extended);

}  // namespace culprit::study
