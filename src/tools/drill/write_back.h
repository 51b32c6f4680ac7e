// Measured numbers into a rule file: only what was measured is changed, and each changed line says where its number
// comes from. Comments and layout stay.
//
//     STRATEGY rgb_redeploy 95 20    # drill 2026-12-01, 20 times
#pragma once

#include <string>
#include <vector>

#include "drill/results.h"

namespace culprit::drill {

struct WrittenBack {
  std::string text;                    // the new file
  std::vector<std::string> unwritten;  // measured numbers without a place in this file, and why
};

// `text` is the rule file that the drill ran with. Errors: it cannot be parsed any more.
// Probability, confidence and impact need kRepeats outcomes, a threshold enough healthy values.
Expected<WrittenBack> write_back(const std::string& name, const std::string& text,
                                 const Results& results);

}  // namespace culprit::drill
