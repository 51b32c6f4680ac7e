// Tables of the paper's claims, with our verdicts.
#pragma once

#include <string>
#include <vector>

#include "study/claim.h"
#include "study/comparison.h"
#include "study/findings.h"
#include "study/tables/table.h"

namespace culprit::study {

// A row for each claim, three columns for each ablation. @pre !ablations.empty()
Table claims_table(const Findings& findings, const std::vector<Ablation>& ablations);

// The rank correlation of each metric. @pre !ablations.empty()
Table order_table(const std::vector<Ablation>& ablations);

// Shared by all tables of claims: our result, p, and the verdict.
std::vector<Column> claim_columns(const std::string& group);
void add_claim_cells(std::vector<Cell>& cells, const Claim& claim);
std::vector<std::string> claim_notes();

}  // namespace culprit::study
