// Runs and campaigns as JSON, as shard files hold them. Numbers come back to the last bit.
#pragma once

#include <nlohmann/json.hpp>

#include "language/expected.h"
#include "study/campaign.h"
#include "study/run_metrics.h"

namespace culprit::study {

// An error if a number is not finite: it would not come back.
Expected<nlohmann::ordered_json> to_json(const RunMetrics& run);
// An error says which field is missing or out of range. Unknown fields are errors, too.
Expected<RunMetrics> run_from_json(const nlohmann::ordered_json& json);

nlohmann::ordered_json to_json(const Campaign& campaign);
// A campaign has at least one row, none twice, and at least one run.
Expected<Campaign> campaign_from_json(const nlohmann::ordered_json& json);

}  // namespace culprit::study
