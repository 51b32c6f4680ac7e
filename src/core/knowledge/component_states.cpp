#include "knowledge/component_states.h"

namespace culprit {

std::string_view to_string(Lifecycle state) {
  switch (state) {
    case Lifecycle::kUnknown:
      return "unknown";
    case Lifecycle::kUnconfigured:
      return "unconfigured";
    case Lifecycle::kInactive:
      return "inactive";
    case Lifecycle::kActive:
      return "active";
    case Lifecycle::kFinalized:
      return "finalized";
    case Lifecycle::kTransition:
      return "in transition";
  }
  return "";
}

}  // namespace culprit
