// STRATEGY and ADAPTATION lines -> entries of the rule set under construction.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "language/condition_checks.h"
#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/symbols.h"
#include "language/syntax.h"
#include "language/typing.h"

namespace culprit {

class StrategyEntries {
 public:
  // All must outlive it.
  StrategyEntries(RuleSet& rules, Symbols& symbols, std::vector<Diagnostic>& diagnostics)
      : rules_(rules), symbols_(symbols), diagnostics_(diagnostics) {}

  // Enters a strategy of `rule`, and what it adapts among the rule's components. Its WHEN goes to
  // `conditions`; null: the trigger of the rule could not be read.
  void add(const syntax::Strategy& written, RuleId rule, RuleConditions* conditions);

 private:
  void check_numbers(const syntax::Strategy& written);
  void add_adaptations(const syntax::Strategy& written, Strategy& strategy);
  void add_adaptation(const syntax::Adaptation& written, Strategy& strategy);
  void add_request(const syntax::Name& written, Adaptation& adaptation);
  void add_group(const syntax::Adaptation& written, Strategy& strategy);
  Cycles impact_of(const syntax::Adaptation& written);
  void adaptation_value(const syntax::Adaptation& written, const Typed& typed,
                        Adaptation& adaptation);
  void check_value(const syntax::Adaptation& written, const Typed& typed, ParameterId parameter);
  void report(Code code, Span span, std::string cause, std::string remedy);

  RuleSet& rules_;
  Symbols& symbols_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace culprit
