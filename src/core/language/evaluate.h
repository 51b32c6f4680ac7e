// Runs a program. See program.h for what the results mean.
#pragma once

#include <span>

#include "language/program.h"

namespace culprit {

// `inputs` is indexed by InputId and has the types that the rule set gave them. Allocates nothing,
// throws nothing.
// @pre `program` came from the compiler together with the rule set that `inputs` belongs to.
Slot evaluate(const Program& program, std::span<const Slot> inputs);

// The same, as if some inputs had other values.
struct Assumed {
  InputId input;
  Slot value;
};
Slot evaluate(const Program& program, std::span<const Slot> inputs,
              std::span<const Assumed> assumed);

// A known result as a value; for programs whose result is no duration (a duration gives its
// seconds).
Value to_value(const Slot& slot, Type type);

}  // namespace culprit
