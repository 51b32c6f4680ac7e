#include "knowledge/why_unknown.h"

namespace culprit {

std::string_view to_string(WhyUnknown why) {
  switch (why) {
    case WhyUnknown::kNoValue:
      return "no_value";
    case WhyUnknown::kStale:
      return "stale";
    case WhyUnknown::kNotCovered:
      return "not_covered";
    case WhyUnknown::kNotANumber:
      return "not_a_number";
    case WhyUnknown::kUnreadable:
      return "unreadable";
    case WhyUnknown::kOverflow:
      return "overflow";
  }
  return "";
}

}  // namespace culprit
