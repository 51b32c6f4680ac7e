// A rule file -> its JSON form (docs/rule-json.md, docs/rules.schema.json): every statement with
// its parts, every comment, every blank line. Layout is left out; there is one canonical one.
#pragma once

#include "base/expected.h"
#include "language/diagnostic.h"
#include "language/source.h"
#include "rule_json/spelling.h"

namespace culprit::rule_json {

// The version of the form. Another number is for a form that readers of this one cannot read.
inline constexpr int kVersion = 1;

// Errors: the text does not parse; the message is what a check says about it, rendered in `colour`.
// Or it is not UTF-8, which JSON cannot hold.
Expected<Json> to_json(const Source& source, Colour colour = Colour::kOff);

// As `culprit export` prints it.
std::string to_text(const Json& document);

}  // namespace culprit::rule_json
