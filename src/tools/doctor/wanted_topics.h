// Which topics of a robot have to be listened to, so that findings can be made of them.
#pragma once

#include <cstdint>
#include <vector>

#include "doctor/listening.h"
#include "doctor/picture.h"

namespace culprit::doctor {

enum class Extent : std::uint8_t {
  kFindings,    // what findings need
  kEverything,  // a robot as it is: also all rates and parameters
};

// Only topics that a node of the robot reads. First those whose silence is a finding (with a deadline, latched with possible late joiners, of sensors), for not
// all may have their turn. Without /tf, /clock and /diagnostics, which have listeners of their own.
std::vector<WantedTopic> wanted_topics(const Picture& picture, Extent extent);

}  // namespace culprit::doctor
