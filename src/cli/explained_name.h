// culprit explain NAME: what a name of the rules stands for, and which decision was the latest about it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "journal/reader.h"
#include "language/rule_set.h"

namespace culprit::cli {

struct ExplainedName {
  std::string kind;                // "rule", "component", "strategy"
  std::vector<std::string> rules;  // that it is, belongs to, or that act on it
  std::string text;                // lines for people
};

// Nothing: no rule, component (or node of one) or strategy ("Rule.strategy" too) is called so.
std::optional<ExplainedName> find_name(const RuleSet& rules, const std::string& name);

// The name of a rule, component or strategy that was probably meant; empty if none is near.
std::string nearest_name(const RuleSet& rules, const std::string& name);

// Those of the latest run. Nothing: the journal does not have them. Errors: it cannot be read.
Expected<std::optional<RuleSet>> latest_rules(const journal::Reader& journal);

}  // namespace culprit::cli
