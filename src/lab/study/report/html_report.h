// A study as one HTML page (page.h).
//
// How it was made (command, seed, version), how well it agrees with the paper, all tables, a plot
// of each metric, learning curves, and a timeline of each run that was asked for. Only the choice
// of a run's timeline needs its script.
#pragma once

#include <string>

#include "study/findings.h"

namespace culprit::study {

// `title` is the study's, as "SUNSET".
std::string html_report(const Findings& findings, const std::string& title);

}  // namespace culprit::study
