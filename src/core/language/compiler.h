// Typed tree -> program, in postfix order.
#pragma once

#include <cstddef>
#include <vector>

#include "language/program.h"
#include "language/typing.h"

namespace culprit {

Program compile(const Typed& expression);

// How many slots of the stack the compiled expression needs.
std::size_t stack_need(const Typed& expression);

bool reads_inputs(const Typed& expression);

// The constants that a comparison has an input on the other side of, as the monitor counts: durations
// in seconds. A condition that is none has none.
std::vector<double> thresholds_of(const Typed& comparison);

// Enters into `inputs` the constants that `trigger` compares its inputs with, in any order and also
// twice, and which inputs it uses in other ways.
void collect_thresholds(const Typed& trigger, std::vector<Input>& inputs);

}  // namespace culprit
