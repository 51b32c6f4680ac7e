// A rule file as commands read it.
#pragma once

#include <memory>
#include <string>

#include "live/rule_file.h"

namespace culprit::cli {

// Reads and checks a rule file. Prints its mistakes to stderr; null if any is an error.
std::unique_ptr<const RuleSet> load_rules(const std::string& path);

}  // namespace culprit::cli
