// Runs and campaigns as JSON, as shard files hold them. Numbers come back to the last bit. Those of
// SUNSET are here, those of SUAVE in suave_record.h.
#pragma once

#include <cstdint>

#include "base/expected.h"
#include "json/json.h"
#include "study/campaign.h"
#include "study/run_metrics.h"

namespace culprit::study {

inline constexpr std::uint64_t kMostShardedRuns = 1'000'000'000;  // of a row

// An error if a number is not finite: it would not come back.
Expected<Json> to_json(const RunMetrics& run);
// An error says which field is missing or out of range. Unknown fields are errors, too.
template <class Run>
Expected<Run> run_from_json(const Json& json);
template <>
Expected<RunMetrics> run_from_json(const Json& json);

Json to_json(const Campaign& campaign);
// A campaign has at least one row, none twice, and at least one run.
template <class C>
Expected<C> campaign_from_json(const Json& json);
template <>
Expected<Campaign> campaign_from_json(const Json& json);

}  // namespace culprit::study
