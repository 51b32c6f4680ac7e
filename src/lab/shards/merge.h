// Puts the shards of a campaign together.
//
// Runs are folded in the campaign's order, so the result is the same to the last bit as that of one
// process. Shards of different campaigns, versions or seeds, shards that are there twice, missing,
// unfinished or damaged are errors, and there is no result then: nothing is merged by halves.
#pragma once

#include <istream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/expected.h"
#include "study/campaign_result.h"
#include "suave_study/campaign.h"

namespace culprit::study {

struct ShardSource {
  std::string name;  // for messages
  std::istream* in = nullptr;
};

// The type follows the first shard.
using Merged = std::variant<CampaignResult, SuaveResult>;

Expected<Merged> merge(std::span<const ShardSource> shards);

// The same of files.
Expected<Merged> merge_files(const std::vector<std::string>& paths);

}  // namespace culprit::study
