// Every place where a rule file names something: for going to a definition, finding uses, renaming,
// and for looking everything up on a robot.
#pragma once

#include <string>
#include <vector>

#include "language/syntax.h"

namespace culprit {

struct Occurrence {
  enum class Kind : std::uint8_t {
    kConstant,
    kComponent,
    kSignal,
    kTopic,      // its scope is the component whose namespace it is relative to; or empty
    kParameter,  // its scope is the component
    kRule,
    kStrategy,  // its scope is the rule
    kFunction,
    kDiagnostic,  // a status
    kService,     // its scope as a topic's
    kAction,
    kTemplate,
    kHole,  // "{parameter}" or its declaration; its scope is the template
    kFile   // that is included
  };
  Kind kind = Kind::kConstant;
  std::string name;
  std::string scope;
  Span span;
  bool declares = false;

  // Whether both name the same thing.
  bool same_as(const Occurrence& other) const {
    return kind == other.kind && name == other.name && scope == other.scope;
  }
};

// In the order of the text. A name in an expression that the file declares as a constant is that
// constant, any other one is a signal. A declaration in a template has the template for its scope;
// names with parameters in them are left out.
std::vector<Occurrence> occurrences(const syntax::File& file);
// The same, with the parameters of templates. `file` is the tree of `source`.
std::vector<Occurrence> occurrences(const syntax::File& file, const Source& source);

// The one that holds the byte `offset` or ends there; null if there is none.
const Occurrence* occurrence_at(const std::vector<Occurrence>& all, std::uint32_t offset);

}  // namespace culprit
