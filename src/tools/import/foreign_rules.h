// A rule file of the reference manager as it is written, whichever of its two dialects it is in.
//
// The tree keeps what culprit's own tree has no place for: which numbers are not given, what stands
// in comments, and what a reader has noted about a part that culprit takes differently.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "language/source.h"
#include "language/syntax.h"

namespace culprit::foreign {

using syntax::AdaptationType;
using syntax::Criticality;
using syntax::Expression;

// A run of non-blank characters.
struct Word {
  std::string text;
  Span span;
};

// Remarks about a part: comments of the file, and notes for the person who imports it.
struct Remarks {
  std::uint32_t line = 0;             // where the part stands, from 1
  std::vector<std::string> comments;  // above it
  std::string comment_behind;
  std::vector<std::string> notes;
};

struct Constant {
  Remarks remarks;
  std::string type;  // bool, string, int or double, as written
  std::string name;
  syntax::Literal value;
  std::string value_text;
};

struct Adaptation {
  Remarks remarks;
  std::string component;
  AdaptationType type = AdaptationType::kRestart;
  std::string subject;              // parameter or mode; empty for types without one
  std::optional<Expression> value;  // of a parameter, or the topic as an expression
  std::optional<double> impact;     // cycles
};

struct Strategy {
  Remarks remarks;
  std::string name;
  std::optional<double> probability;  // percent
  std::optional<double> confidence;   // attempts
  std::vector<Adaptation> adaptations;
};

struct Rule {
  Remarks remarks;
  std::string name;
  std::optional<Criticality> criticality;
  bool on_change = false;
  bool repeats = false;  // the adaptation is ordered again and again while the trigger is true
  std::int64_t hold_needed = 1;
  std::int64_t hold_window = 1;
  Expression trigger;
  std::vector<Strategy> strategies;
};

struct File {
  std::string dialect;  // for people
  std::vector<Constant> constants;
  std::vector<Constant> without_value;  // lines that declare a constant and give it no value
  bool last_constant_counts = false;    // of several with one name
  std::vector<Rule> rules;
  std::vector<std::string> comments_at_end;
};

}  // namespace culprit::foreign
