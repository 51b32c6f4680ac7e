// The SUAVE study as one HTML page (report/page.h): how it was made, its tables, and one run of
// each manager from above, drawn and moving. It needs no script.
#pragma once

#include <string>
#include <vector>

#include "suave_study/campaign.h"
#include "suave_study/track.h"

namespace culprit::study {

// `tracks` are of the campaign's first run.
std::string suave_html(const SuaveResult& result, const std::vector<Track>& tracks);

}  // namespace culprit::study
