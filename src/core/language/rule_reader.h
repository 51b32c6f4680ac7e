// The lines of rules: RULE, POLICIES, TRIGGER, STRATEGY, ADAPTATION and THEN ADAPTATION. A rule goes
// on until the next RULE; declarations may stand in between.
#pragma once

#include <string>
#include <string_view>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// Each method that is named after a keyword reads the line behind it. False: the line is not
// understood, and was reported.
class RuleReader {
 public:
  RuleReader(const Source& source, LineReader& read) : source_(source), read_(read) {}

  // Before each line: the file that its statement becomes part of, its keyword, and whether the line
  // above is no statement at all.
  // @pre `into` outlives the rule
  void begin_line(syntax::File& into, Span keyword, bool is_below_unknown_line);
  // The line was not understood: whatever its absence would make look wrong stays unreported.
  void broken();
  // The rule ends here, as at an INCLUDE.
  void end_rule() { is_in_rule_ = false; }
  bool is_in_rule() const { return is_in_rule_; }
  bool has_trigger() const { return is_in_rule_ && into_->rules.back().trigger; }  // that rule

  bool rule(Scanner& s);
  bool policies(Scanner& s);
  bool trigger(Scanner& s);
  bool strategy(Scanner& s);
  bool adaptation(Scanner& s);
  bool step(Scanner& s);  // THEN ADAPTATION …

 private:
  bool criticality(Scanner& s, syntax::Policies& policies);
  bool policy(Scanner& s, syntax::Policies& policies);
  bool has_condition(Scanner& s);
  bool strategy_ends(Scanner& s);
  bool is_name_last(const Scanner& s);
  // The rule whose first line was not understood, and was reported.
  void begin_unnamed_rule();
  bool inside_rule(std::string_view keyword);
  bool duplicate_line(const std::string& keyword);

  const Source& source_;
  LineReader& read_;
  syntax::File* into_ = nullptr;
  Span keyword_;
  bool is_below_unknown_line_ = false;
  bool is_in_rule_ = false;            // a part of a rule would belong to the last one
  bool stray_part_ = false;            // a part of a rule stood before any RULE line
  bool has_stray_adaptation_ = false;  // it stood above all strategies of the rule at hand
  bool has_duplicate_line_ = false;    // of the rule at hand, which was reported
};

}  // namespace culprit
