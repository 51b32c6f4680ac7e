// Cases of the public benchmark on the exemplars in virtual time (rca_study/export.h): SUNSET and the
// rover, each with one fault that nobody repairs.
//
// culprit only advises, and answers with its incidents. A component's reading is 1 while a failure is
// there that the rules repair first at this component. A fault makes a case if it shows at another
// component.
//
// SUAVE has no such fault: none of its uncertainties shows at another component.
#pragma once

#include <cstdint>
#include <vector>

#include "rca_study/cases.h"

namespace culprit::study {

enum class Faults : std::uint8_t {
  kEach,  // one after the other
  kDrawn  // as many, drawn at random, so that no public case tells which one a hidden case has
};

// `of_each` cases of each fault, or as many of drawn ones. Those that do not count are left out. The
// same seed gives the same cases.
std::vector<rca::RcaCase> sunset_cases(std::uint64_t seed, std::size_t of_each,
                                       Faults faults = Faults::kEach);
std::vector<rca::RcaCase> rover_cases(std::uint64_t seed, std::size_t of_each,
                                      Faults faults = Faults::kEach);

}  // namespace culprit::study
