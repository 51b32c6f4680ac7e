// The results of a campaign over SUAVE: tables, ours beside the paper's, and JSON.
//
//     {"study": "suave", "campaign": {...},
//      "rows": [{"manager": "bt", "mission": "standard", "runs": 100, "outliers": 0,
//                "search_time_s": {"mean": 84.1, "sd": 26.4}, "distance_m": {...},
//                "reaction_s": {"visibility": {"mean", "sd", "count"}, "thruster": {...},
//                               "battery": {...}},
//                "published": {"search_time_s": {...}, "distance_m": {...},
//                              "reaction_s": {"visibility": 0.1, ...}},
//                "honest": {"found": 100, "successes": 100, "search_time_s": {...},
//                           "distance_m": {...}, "whole_distance_m": {...},
//                           "unanswered": {"visibility": 0, "thruster": 0, "battery": 0}}}],
//      "tests": [{"first": "bt", "second": "culprit", "metric": "distance_m", "t", "degrees", "p",
//                 "difference"}]}
//
// "campaign" is as in shard files (shards/suave_record.h). Standard deviations are those of a
// sample. Without values, mean and sd are null; "published" is null where the paper has no such
// row.
#pragma once

#include <string>
#include <vector>

#include "study/tables/table.h"
#include "suave_study/campaign.h"

namespace culprit::study {

std::vector<Table> suave_tables(const SuaveResult& result);

std::string suave_json(const SuaveResult& result);

}  // namespace culprit::study
