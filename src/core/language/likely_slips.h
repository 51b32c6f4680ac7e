// Design-time checks of text that is allowed but was hardly meant. All are warnings.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"

namespace culprit {

// An adaptation that starts a process and counts on less time than any process takes; an impact in
// milliseconds.
void check_impacts(const syntax::Rule& rule, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics);

// A statement for the whole file, such as INTERLOCK, that stands among the lines of a rule.
void check_settings_in_rules(const syntax::File& file, std::vector<Diagnostic>& diagnostics);

// A LAUNCH command written for a shell: source ... && ..., NAME=value program, a pipe. `component` is
// what `written` declares.
void check_shell(const syntax::Component& written, const Component& component,
                 std::vector<Diagnostic>& diagnostics);

// The full name of a topic that the rules read where a component belongs.
void check_topics_as_components(const syntax::File& file, const RuleSet& rules,
                                std::vector<Diagnostic>& diagnostics);

// The node of a declared component where a topic belongs, in a rule that adapts an undeclared full name:
// the two were exchanged, as in a USE.
void check_nodes_as_topics(const syntax::File& file, const RuleSet& rules,
                           std::vector<Diagnostic>& diagnostics);

// The name of another rule or of a strategy where a value belongs, as if its failure were one.
void check_rules_as_values(const syntax::File& file, std::vector<Diagnostic>& diagnostics);

// A FIELD that begins with the message itself: "msg.percentage".
void check_fields(const syntax::File& file, std::vector<Diagnostic>& diagnostics);

// A signal where level() takes a diagnostic status.
void check_signals_as_statuses(const syntax::File& file, std::vector<Diagnostic>& diagnostics);

// Components that are declared and that nothing in the rules is about, if there are rules.
void check_unused(const syntax::File& file, const RuleSet& rules,
                  std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
