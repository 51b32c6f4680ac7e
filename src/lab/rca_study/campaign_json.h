// A campaign of the root-cause benchmark as JSON: all that is needed to play it again.
//
//     {"settings": [{"components": 200, "faults": 3, "noise": 0, "cyclic": false}],
//      "planners": ["paper", "bayes"], "objective": "balanced", "episodes": 20, "seed": 1,
//      "version": "1.2.3"}
//
// A setting that differs from the usual robots in a factor also has "factors" (factors.h).
//
// With a scenario of its own it has "scenario" (scenario_json.h), and one setting, which says what
// the scenario is like.
#pragma once

#include "base/expected.h"
#include "json/json.h"
#include "rca_study/campaign.h"

namespace culprit::study::rca {

Json to_json(const RcaCampaign& campaign);

// A field that is missing, unknown, out of range or inconsistent is an error that names the place.
Expected<RcaCampaign> campaign_from_json(const Json& json);

}  // namespace culprit::study::rca
