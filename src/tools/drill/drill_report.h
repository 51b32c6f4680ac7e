// A drill's results for people, for programs, and as one page.
#pragma once

#include <string>
#include <vector>

#include "drill/results.h"

namespace culprit::drill {

// One trial on a line: "kill camera: noticed after 0.41 s by RGBDead, ..."
std::string line_of(const Trial& trial);

std::vector<std::string> report_lines(const Results& results);
Json report_json(const Results& results);
// One file, without anything from elsewhere.
std::string report_page(const Results& results);

// Thresholds alone: of a look that injects nothing.
std::vector<std::string> threshold_lines(const std::vector<ThresholdMeasure>& thresholds);

}  // namespace culprit::drill
