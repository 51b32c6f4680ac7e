// An incident in words, for lists and alerts.
#pragma once

#include <string>

#include "incident_reports/incident.h"

namespace culprit::incident_reports {

// "camera and fusion": the blamed components; the first rule that failed if there are none.
std::string cause_of(const Incident& incident);
// How it ended: what helped, "cleared without a repair", "given up: a person must look", "not over" ...
std::string outcome_of(const Incident& incident);

// "40 ms", "0.4 s", "12 s", "3 min 5 s", "2 h 10 min", "1 d 3 h": two figures are enough to act on.
std::string lasting_text(double seconds);

}  // namespace culprit::incident_reports
