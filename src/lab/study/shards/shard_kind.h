// What shard files can hold: for each kind of campaign, what its runs are, what folds them into a
// result, and the name that stands in the files.
#pragma once

#include <string_view>

#include "study/campaign.h"
#include "study/campaign_result.h"
#include "study/run_metrics.h"
#include "study/suave/campaign.h"

namespace culprit::study {

// Of a campaign C, which has size(), operator[] and ==, a version and a command.
template <class C>
struct ShardKind;

template <>
struct ShardKind<Campaign> {
  using Run = RunMetrics;
  using Fold = CampaignFold;
  using Result = CampaignResult;
  static constexpr std::string_view kName = "sunset";
};

template <>
struct ShardKind<SuaveCampaign> {
  using Run = SuaveRun;
  using Fold = SuaveFold;
  using Result = SuaveResult;
  static constexpr std::string_view kName = "suave";
};

}  // namespace culprit::study
