// How ill each component is: as ill as the most critical failing rule that touches it, so that one
// rule's recovery never wipes another's.
#pragma once

#include <string_view>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit::web {

// "OK", "NON_CRITICAL", "WARNING", "ERROR", or "EXHAUSTED": of a rule that has nothing left to try.
inline constexpr std::string_view kHealthWords[] = {"OK", "NON_CRITICAL", "WARNING", "ERROR",
                                                    "EXHAUSTED"};

// By component: an index of kHealthWords.
std::vector<std::size_t> health_of_components(const Knowledge& knowledge);

}  // namespace culprit::web
