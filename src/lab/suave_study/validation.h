// Is the model of SUAVE as good as the real one, on runs that it was not fitted to?
//
// "Within 1 sd" says little where deviations are as large as here. So for each manager, and for
// search time and distance, equivalence is tested (statistics/equivalence.h): a difference of means
// beyond the margin, in standard deviations of the recorded runs, must be ruled out at 5 %. The
// order of the managers answers which one is the best: rank correlations of their means
// (statistics/rank_correlation.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/statistics/equivalence.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"
#include "suave_study/recorded.h"

namespace culprit::study {

struct ValidationRow {
  std::string manager;
  const char* metric;  // as in suave_json(): "search_time_s", "distance_m"
  const char* title;
  Moments recorded;
  Moments modelled;
  bool is_within = false;  // the mean, of the recorded mean ± 1 sd
  std::optional<EquivalenceTest> test;
};

struct RankAgreement {
  const char* metric;
  const char* title;
  std::size_t managers = 0;
  std::optional<double> spearman_rho;
  std::optional<double> kendall_tau;
};

struct Validation {
  SuaveCampaign campaign;
  double margin_sd = 0.5;
  std::vector<std::string> left_out;  // recorded managers that the study has not
  std::vector<ValidationRow> rows;
  std::vector<RankAgreement> ranks;
};

// Plays `campaign` with the managers that were recorded. @pre margin_sd > 0
Validation validate(SuaveCampaign campaign, const RecordedCampaign& recorded, double margin_sd,
                    unsigned jobs);

std::vector<Table> validation_tables(const Validation& validation);

//     {"study": "suave-validation", "campaign": {...}, "margin_sd": 0.5, "left_out": [],
//      "rows": [{"manager": "bt", "metric": "search_time_s", "recorded": {"count", "mean", "sd"},
//      "modelled": {...},
//                "within_1_sd": true, "difference", "low", "high", "margin", "p", "equivalent"}],
//      "ranks": [{"metric", "managers", "spearman_rho", "kendall_tau"}]}
//
// low and high are those of the 90 % interval of modelled minus recorded. Values that cannot be
// tested are null.
std::string validation_json(const Validation& validation);

}  // namespace culprit::study
