// A drill's findings as priors of the culprit that manages the robot afterwards: how surely failures spread, and how late
// rules show them. Success rates are not among them: they are numbers of the rule file.
#pragma once

#include <filesystem>

#include "base/expected.h"

namespace culprit::drill {

struct Priors {
  std::size_t couplings = 0;
  std::size_t latencies = 0;
};

// Adds what journal `drilled` counted to journal `robot`, which is made if it is not there. `now`: nanoseconds since
// 1970. Errors: a journal cannot be read or written, or another process writes `robot`.
Expected<Priors> add_priors(const std::filesystem::path& drilled,
                            const std::filesystem::path& robot, std::int64_t now);

}  // namespace culprit::drill
