// The statements that tests and states share: how the robot is made, what the manager reads of it
// over time, and what happens to its components.
#pragma once

#include <string_view>
#include <vector>

#include "language/line_reader.h"
#include "language/rule_set.h"
#include "language/scanner.h"
#include "language/source.h"
#include "rule_test/names.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

class SetupReader {
 public:
  // All must outlive the reader.
  SetupReader(const Source& source, const RuleSet& rules, LineReader& read, Names& names)
      : source_(source), rules_(rules), read_(read), names_(names) {}

  // COMPONENT, TOPIC, SIGNAL, LEVEL, PARAMETER, GOAL, LOG and AT.
  static const std::vector<std::string_view>& keywords();

  // Reads what follows `keyword` and adds it to `scenario`, or reports and gives false if it cannot
  // be understood.
  // @pre `keyword` is one of keywords()
  bool read(std::string_view keyword, Scanner& s, Scenario& scenario);

 private:
  bool component(Scanner& s);
  bool component_clause(Scanner& s, ComponentId id);
  template <class Take>
  bool each_name(Scanner& s, Take take);
  bool each_endpoint(Scanner& s, ComponentId id, EndpointKind kind, const char* what);
  bool publishes(ComponentId id, const syntax::Name& name);
  bool needs(ComponentId consumer, const syntax::Name& name);
  bool initial_state(Scanner& s, ComponentId id);

  bool topic(Scanner& s);
  bool goal(Scanner& s);
  bool log(Scanner& s);
  bool signal(Scanner& s);
  bool level(Scanner& s);
  bool parameter(Scanner& s);
  bool course(Scanner& s, Subject subject);

  bool at(Scanner& s);
  bool is_subject_of_at(const Scanner& s);

  const Source& source_;
  const RuleSet& rules_;
  LineReader& read_;
  Names& names_;
  Scenario* scenario_ = nullptr;  // of the statement that is read
};

// Whether a line of a rule file begins with it; a word in upper case.
bool is_of_rules(std::string_view upper);

// Reports that a line begins with `head`, which is none of `keywords`. Gives the one that was meant;
// empty: none is near.
std::string fail_unknown_statement(LineReader& read, const Source& source, const Token& head,
                                   const std::vector<std::string_view>& keywords);

}  // namespace culprit::rule_test
