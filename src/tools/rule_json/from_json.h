// The JSON form of a rule set -> rule text in the canonical layout (docs/rule-json.md).
//
// JSON comes from other programs and is not trusted: each value has to be exactly the part of a
// line that it stands for, so nothing can be slipped into another one.
#pragma once

#include <string>

#include "base/expected.h"

namespace culprit::rule_json {

// `name` is what messages call the document. Errors: a line for each mistake, with its place as a
// JSON pointer (RFC 6901). The result parses; a check must find out whether it makes sense.
Expected<std::string> to_rules(const std::string& name, const std::string& json);

}  // namespace culprit::rule_json
