// Detectors of SUNSET's outages: its own monitoring, as in the paper; culprit's, on the topics; or
// an oracle.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "base/expected.h"

namespace culprit::study {

enum class Detectors : std::uint8_t {
  kOwn,   // the profile's: the exemplar's blackboard, by the rules of the study; live, ages
  kAge,   // three messages missed: rules/sunset.rules, which the live robot is managed by
  kPhi,   // the same, but a silence that one interval in 10^8 is as long as
  kKnown  // the same, but the fault itself is seen at once: a bound for all detectors
};

// "paper:age" is profile "paper" with detectors of ages; without a colon they are its own.
Expected<std::pair<std::string, Detectors>> parse_profile(std::string_view text);

// rules/sunset.rules, `text`, whose outages are seen by age, with phi in its place.
std::string with_phi(std::string text);

// The same, with the faults themselves: which component is out is known at once, though not what
// ends it. A fault is a parameter that the exemplar breaks.
std::string with_faults_known(std::string text);

}  // namespace culprit::study
