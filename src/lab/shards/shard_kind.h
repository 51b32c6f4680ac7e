// The kinds of campaign in shard files: the type of their runs, and the function that folds them
// into a result.
#pragma once

#include "study/campaign.h"
#include "study/campaign_result.h"
#include "study/run_metrics.h"
#include "suave_study/campaign.h"

namespace culprit::study {

// A campaign C has size(), operator[] and ==, a version, a command, and kStudy, the name in the
// files.
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
