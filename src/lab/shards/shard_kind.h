// What shard files can hold: for each kind of campaign, what its runs are, and what folds them into
// a result.
#pragma once

#include "study/campaign.h"
#include "study/campaign_result.h"
#include "study/run_metrics.h"
#include "suave_study/campaign.h"

namespace culprit::study {

// Of a campaign C, which has size(), operator[] and ==, a version, a command, and kStudy, the name
// that stands in the files.
template <class C>
struct ShardKind;

template <>
struct ShardKind<Campaign> {
  using Run = RunMetrics;
  using Fold = CampaignFold;
  using Result = CampaignResult;
};

template <>
struct ShardKind<SuaveCampaign> {
  using Run = SuaveRun;
  using Fold = SuaveFold;
  using Result = SuaveResult;
};

}  // namespace culprit::study
