// Runs and campaigns of SUAVE as JSON (as run_record.h).
#pragma once

#include "study/run_record.h"
#include "suave_study/campaign.h"

namespace culprit::study {

Expected<Json> to_json(const SuaveRun& run);
template <>
Expected<SuaveRun> run_from_json(const Json& json);

Json to_json(const SuaveCampaign& campaign);
// A campaign has managers, missions and generations that there are, and at least one run.
template <>
Expected<SuaveCampaign> campaign_from_json(const Json& json);

}  // namespace culprit::study
