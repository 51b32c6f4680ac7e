// The SUAVE study as one HTML page (report/page.h): how it was made, its tables, and one run of
// each manager from above, drawn and moving. It needs no script.
#pragma once

#include <string>
#include <vector>

#include "study/suave/campaign.h"
#include "study/suave/track.h"

namespace culprit::study {

// `command` and `version` are those that made it. `tracks` are of the campaign's first run.
std::string suave_html(const SuaveCampaign& campaign, const std::vector<SuaveRow>& rows,
                       const std::vector<Track>& tracks, const std::string& command,
                       const std::string& version);

}  // namespace culprit::study
