// How a metric is distributed in each configuration, beside the paper's mean.
//
// One row for each configuration: a histogram of its values, our mean with the 95 % interval of the
// mean, and the paper's mean ± 1 sd where it has one. Bars of a row are as high as their share of
// the row's highest.
#pragma once

#include "study/campaign_result.h"
#include "study/plot/svg.h"

namespace culprit::study {

// @pre has_values(result, metric)
Svg distribution_plot(const CampaignResult& result, Metric metric);

bool has_values(const CampaignResult& result, Metric metric);

}  // namespace culprit::study
