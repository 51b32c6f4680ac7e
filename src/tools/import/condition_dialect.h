// The reference's older dialect:
//
//   RULE name [ON_TRIGGER_CHANGE|ON_EVERY_TRIGGER]
//   COMPONENTS [component, component]
//   IF ((a < b) AND ((c == d) OR (e != f)))
//   THEN action [parameter key]
//
// Operands are names of constants or of monitored values. Every component gets the one adaptation;
// there are no levels, no strategies and no impacts.
#pragma once

#include "base/expected.h"
#include "import/foreign_rules.h"
#include "language/source.h"

namespace culprit::foreign {

Expected<File> read_condition_dialect(const Source& source);

}  // namespace culprit::foreign
