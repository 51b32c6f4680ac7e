// Rules that are nearest to firing, while they are quiet.
//
// Only comparisons of one value with a constant are looked at: for anything else no number says how
// near it is.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

struct NearTrigger {
  RuleId rule;
  InputId input;         // that its trigger compares
  double value = 0;      // what the input is; durations in seconds
  double threshold = 0;  // what it is compared with
  double distance = 0;   // of the two, as a share of the larger one: 0..2
};

// For each quiet rule the nearest comparison of its trigger that is not true, if it has one at a
// distance of at most a half: the nearest first, at most `most`.
std::vector<NearTrigger> near_triggers(const Knowledge& knowledge, std::size_t most);

}  // namespace culprit
