// Values to draw over time: the rate and the age of each topic, and each input of the rules that is a number.
#pragma once

#include <string>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

// "rate /scan" (Hz, 0 while it is silent), "age /scan" (s), "input entropy": an input as the rules name it, truth as 0 or 1,
// durations in s.
std::vector<std::string> plotted_names(const RuleSet& rules);
// One for each of those names. NaN: unknown.
std::vector<float> plotted_values(const Knowledge& knowledge);

}  // namespace culprit
