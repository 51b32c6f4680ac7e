// A rule file as it is managed by.
#pragma once

#include <string>

#include "language/checker.h"

namespace culprit::live {

struct LoadedRules {
  RuleSet rules;
  Source source;        // the file, with all that it includes and uses put in
  std::string remarks;  // warnings, as a person reads them
};

// Errors: the file cannot be read, or has errors, which are shown.
Expected<LoadedRules> read_rules(const std::string& path,
                                 Strictness strictness = Strictness::kLenient,
                                 Colour colour = Colour::kOff);

// The same with rules for components without any (language/improvise.h).
Expected<LoadedRules> improvised(LoadedRules loaded, const std::string& path);

// The rules for `run`: from files that no other user can change (live/rule_trust.h), and improvised
// on request.
Expected<LoadedRules> trusted_rules(const std::string& path, bool improvises, Colour colour);

}  // namespace culprit::live
