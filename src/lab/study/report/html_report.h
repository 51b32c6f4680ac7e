// A study as one HTML page (page.h).
//
// It has the origin (command, seed, version), the agreement with the paper, all tables, a plot of
// each metric, learning curves, and a timeline of each requested run. Only the choice of a run's
// timeline needs its script.
#pragma once

#include <string>

#include "study/findings.h"

namespace culprit::study {

// `title` is the study's, as "SUNSET".
std::string html_report(const Findings& findings, const std::string& title);

}  // namespace culprit::study
