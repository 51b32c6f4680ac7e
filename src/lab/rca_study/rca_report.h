// The results of a campaign of the root-cause benchmark, as tables, CSV and JSON
// (docs/study-rca.md).
//
//     {"study": "rca", "campaign": {...},
//      "rows": [{"planner": "bayes", "components": 200, "faults": 3, "noise": 0, "cyclic": true,
//                "episodes": 100, "exact_set": 0.95, "top1": 0.99, "path": 0.98,
//                "wrong_component": 0.04, "unnecessary": 0.01, "strategies_per_fault": 1.6,
//                "downtime_s": 6.1, "recovery_s": 11.2, "unresolved": 0, "regret": null,
//                "plan_us": null, "on_front": true}]}
//
// "campaign" is campaign_json.h's. exact_set, top1 and path are shares; the rest are means over the
// episodes. A missing value is null: path where no failure waited for another, regret where the
// optimum was not played, on_front of the optimum. So is plan_us unless times are asked for,
// because they are never the same twice. on_front says whether no other planner beats this one
// (study/pareto.h) in exact_set, wrong_component, unnecessary, strategies_per_fault, downtime_s,
// recovery_s and unresolved together.
#pragma once

#include <string>
#include <vector>

#include "rca_study/campaign.h"
#include "study/tables/table.h"

namespace culprit::study::rca {

enum class Times : std::uint8_t { kLeftOut, kShown };

Table rca_table(const RcaCampaign& campaign, const std::vector<RcaRow>& rows, Times times);
std::string rca_csv(const std::vector<RcaRow>& rows, Times times);
std::string rca_json(const RcaCampaign& campaign, const std::vector<RcaRow>& rows, Times times);

}  // namespace culprit::study::rca
