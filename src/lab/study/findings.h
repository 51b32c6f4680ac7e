// All that one command of a study found, as it goes into tables, files and reports.
#pragma once

#include <vector>

#include "study/campaign_result.h"
#include "study/learning.h"
#include "study/timeline.h"

namespace culprit::study {

struct Findings {
  CampaignResult campaign;
  std::vector<LearningCurve> learning;  // empty if nothing was learned
  std::vector<Timeline> timelines;      // of the runs that were asked for
};

}  // namespace culprit::study
