// Every claim of the paper's evaluation on SUNSET that its runs can test, judged on ours.
//
// Two means are alike if they differ by less than the margin of --validate, half the published
// standard deviation (in that configuration); chosen before these tests, with the old tables known.
// A learned rate is right within 0.1: of the rate at which the outcomes that were learned from ended
// the fault and, since the learner selects these, also of the rate over all executions.
//
// Our reaction times of one run are not independent, and count for less (statistics/clusters.h). The
// paper does not print how many it pooled; they count as one a run.
#pragma once

#include <optional>
#include <vector>

#include "study/claim.h"
#include "study/comparison.h"
#include "study/findings.h"

namespace culprit::study {

// Judged. Claims on robustness and learning are there if `findings` has the runs for them.
std::vector<Claim> paper_claims(const Findings& findings, const Ablation& ablation);

// Do the eight configurations come in the paper's order?
struct OrderAgreement {
  Metric metric = Metric::kRatio;
  // The pairs, of 28, that differ significantly in the paper (Tukey's HSD on its summaries), and the
  // number of them that we order the same way.
  int pairs = 0;
  int same = 0;
  std::optional<double> spearman_rho;
  std::optional<double> p;  // of rho, two-sided, over all permutations
};

// For each published metric.
std::vector<OrderAgreement> order_agreement(const Ablation& ablation);

}  // namespace culprit::study
