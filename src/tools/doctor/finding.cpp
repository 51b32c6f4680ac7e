#include "doctor/finding.h"

namespace culprit::doctor {

std::string label(Gravity gravity) { return gravity == Gravity::kError ? "error" : "warning"; }

}  // namespace culprit::doctor
