// For results that change nothing: the compiler warns of those that are passed over.
#pragma once

namespace culprit_link {

inline void ignore(int /*result*/) {}

}  // namespace culprit_link
