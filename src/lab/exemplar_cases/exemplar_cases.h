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

// `of_each` cases of each fault. The same seed gives the same cases.
std::vector<rca::RcaCase> sunset_cases(std::uint64_t seed, std::size_t of_each);
std::vector<rca::RcaCase> rover_cases(std::uint64_t seed, std::size_t of_each);

}  // namespace culprit::study
