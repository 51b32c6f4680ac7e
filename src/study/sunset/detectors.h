// How SUNSET's outages are seen: by its own monitoring, as in the paper, or by culprit on the
// topics.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "language/expected.h"

namespace culprit::study {

enum class Detectors : std::uint8_t {
  kOwn,  // the profile's: the exemplar's blackboard, by the rules of the study; live, ages
  kAge,  // three messages missed: rules/sunset.rules, which the live robot is managed by
  kPhi   // the same, but a silence that one interval in 10^8 is as long as
};

// "paper:age" is profile "paper" with detectors of ages; without a colon they are its own.
Expected<std::pair<std::string, Detectors>> parse_profile(std::string_view text);

// rules/sunset.rules, `text`, whose outages are seen by age, with phi in its place.
std::string with_phi(std::string text);

}  // namespace culprit::study
