// The reference's newer dialect:
//
//   RULE name
//     POLICIES OK|DEGRADED|FAILURE ON_TICK|ON_CHANGE n/k
//     TRIGGER expression
//     STRATEGY name probability [confidence]
//       ADAPTATION component action [parameter expression] [impact]
//
// The numbers in brackets are there in files that the reference has learned from. The words of the
// paper (NON_CRITICAL, WARNING, ERROR; actions without action_) are understood too.
#pragma once

#include "base/expected.h"
#include "import/foreign_rules.h"
#include "language/source.h"

namespace culprit::foreign {

Expected<File> read_strategy_dialect(const Source& source);

}  // namespace culprit::foreign
