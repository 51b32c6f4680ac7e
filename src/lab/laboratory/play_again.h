// One run of a campaign, played again with all reported events, for people who look at it moment by
// moment.
//
// It depends on nothing but its campaign and its number, so nothing of it has to be kept.
#pragma once

#include <string_view>

#include "base/expected.h"
#include "json/json.h"
#include "study/campaign.h"
#include "study/single_run.h"

namespace culprit::lab {

// `study` and `campaign` are what a result says (sunset_study/json.h, suave_study/suave_report.h,
// rca_study/rca_report.h), of whatever origin. Errors: the campaign is invalid; it has no such run.
Expected<study::SingleRun> play_again(std::string_view study, const Json& campaign,
                                      study::RunId id);

}  // namespace culprit::lab
