// A rule file as commands read it.
#pragma once

#include <memory>
#include <string>

#include "language/checker.h"

namespace culprit::cli {

struct LoadedRules {
  RuleSet rules;
  std::string text;     // of the file
  std::string remarks;  // warnings, as a person reads them
};

// Errors: the file cannot be read, or has errors, which are shown.
Expected<LoadedRules> read_rules(const std::string& path,
                                 Strictness strictness = Strictness::kLenient,
                                 Colour colour = Colour::kOff);

// The same with rules for components that nobody wrote one for (language/improvise.h).
Expected<LoadedRules> improvised(LoadedRules loaded, const std::string& path);

// Reads and checks a rule file. Prints what is wrong with it to stderr; null if that are errors.
std::unique_ptr<const RuleSet> load_rules(const std::string& path,
                                          Strictness strictness = Strictness::kLenient);

}  // namespace culprit::cli
