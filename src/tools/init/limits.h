// A draft's rules and proposals about diagnostics: a rule for each level, which reports, and
// proposals for the numbers of their keys.
#pragma once

#include <string>
#include <vector>

#include "init/names.h"
#include "init/part.h"
#include "init/sighting.h"

namespace culprit::init {

// Adds to `left_out` of what no rule was written, and why.
//
// A status that was no error is one later: a person is told, and nothing is done. Keys are only
// proposed, as comments, with the limits that they kept to: what a robot shows in half a minute is
// not all that is well.
std::vector<Part> limits(const Sighting& seen, Names& names, std::vector<std::string>& left_out);

}  // namespace culprit::init
