// Random rule texts of the whole language, written as carelessly as it allows.
#pragma once

#include <string>
#include <vector>

namespace culprit {

struct RuleText {
  std::string text;
  std::vector<std::string> comments;  // that are in it, in order, without trailing blanks
};

// Well-formed: it parses without a diagnostic. Its content makes no sense. To be called within a
// property.
RuleText random_rule_text();

}  // namespace culprit
