// JSON text -> a document, without what the library would let pass: members of one name, of which
// one gets lost, and objects of a size that takes its ordered members the square of it to read.
#pragma once

#include <string>

#include "base/expected.h"
#include "rule_json/spelling.h"

namespace culprit::rule_json {

// Errors: it is no JSON, it is larger than a rule file may be, an object has two members of one
// name or more members than any statement. The message says where.
Expected<Json> parse_document(const std::string& name, const std::string& text);

}  // namespace culprit::rule_json
