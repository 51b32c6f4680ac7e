// Whether recordings can judge the rules of a file, rule by rule.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "language/rule_set.h"

namespace culprit::cli {

struct BagCheck {
  std::vector<std::string> bags;
  std::vector<std::filesystem::path> message_path;
};

// Prints a line for each rule of `rules`, read from the file `name`. Gives kWarnings if no bag can judge one of them, kFailed
// if a bag cannot be read.
int check_against_bags(const std::string& name, const RuleSet& rules, const BagCheck& options);

}  // namespace culprit::cli
