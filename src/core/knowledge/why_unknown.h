// Why a value that rules read is unknown, as far as its readings show.
#pragma once

#include <cstdint>
#include <string_view>

namespace culprit {

enum class WhyUnknown : std::uint8_t {
  kNoValue,     // no value was read, or it became invalid
  kStale,       // its last value is older than its STALE
  kNotCovered,  // its window is not covered yet, or not again after a gap
  kNotANumber,  // it is NaN, or a result that does not exist
  kUnreadable,  // a value came that is not of the type that the rules read
  kOverflow     // more samples came within its window than are kept
};
// "stale", "not_covered", ...
std::string_view to_string(WhyUnknown why);

}  // namespace culprit
