// Scenario files: the benchmark for others (docs/study-rca.md). JSON; components are referred to by
// name.
//
// A file may come from anywhere: a field that is missing, unknown, out of range or inconsistent is
// refused with its place.
#pragma once

#include <string>

#include "base/expected.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

// Larger robots are not read.
inline constexpr std::size_t kMostComponents = 10'000;

// Ends with a line end. Reading it back gives the same scenario.
std::string to_json(const RcaScenario& scenario);

// Errors: "components[3]: detector is wrong: miss is no probability".
Expected<RcaScenario> scenario_from_json(const std::string& text);

}  // namespace culprit::study::rca
