// Reading a rule file for a command: what is wrong with it is said on stderr.
#pragma once

#include <memory>
#include <string>

#include "language/checker.h"

namespace culprit::cli {

// Null if the file cannot be read or has errors. Warnings are said and do not matter.
std::unique_ptr<const RuleSet> load_rules(const std::string& path,
                                          Strictness strictness = Strictness::kLenient);

}  // namespace culprit::cli
