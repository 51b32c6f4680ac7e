// The evidence for the decisions of an incident as HTML: what began when, on one time axis, and what speaks for and against each suspect.
#pragma once

#include <string>
#include <vector>

#include "json/json.h"

namespace culprit::incident_reports {

// `events` as of a page (incident_page.h); the axis ends at `end`, in seconds since 1970. Empty if no decision gave a time.
std::string onsets_of(const std::vector<Json>& events, double end);
// Of one decision; empty if it gave none.
std::string evidence_of(const Json& decision);

}  // namespace culprit::incident_reports
