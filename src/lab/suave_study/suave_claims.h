// Every claim of the paper's evaluation on SUAVE that its runs can test, judged on ours.
//
// Two means are alike if they differ by less than the margin of --validate, half the published
// standard deviation (of that row); chosen before these tests, with the old tables known. Shares of
// left-out runs are alike if they differ by less than 0.1.
//
// As in the paper, long searches of its own manager are left out, and those of others are not. This
// rule alone makes its search shorter. It also makes its distance longer, because an early find leaves
// more time to inspect. Each claim that the rule may decide is judged again on all runs.
#pragma once

#include "study/claim.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"

namespace culprit::study {

// Judged. @pre both have all managers of the paper's table, and are of these missions
std::vector<Claim> suave_claims(const SuaveResult& standard, const SuaveResult& extended);

Table suave_claims_table(const SuaveResult& standard, const SuaveResult& extended);

}  // namespace culprit::study
