// Bare names in expressions that were meant as something else: a word in place of a value, of a text
// in quotes or of a call.
//
// A name that a file does not declare is a signal, which is looked up on the robot. So
// `lifecycle(camera) == active` would wait for a signal `active` for ever.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "language/diagnostic.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

bool is_call_of(const syntax::Expression& e, std::string_view function);

// The number of a diagnostic's level, as in "ERROR"; null: the word is none.
std::optional<std::string> level_number(std::string_view word);
std::string level_remedy(const std::string& number);

class BareWords {
 public:
  BareWords(Symbols& symbols, std::vector<Diagnostic>& diagnostics)
      : symbols_(symbols), diagnostics_(diagnostics) {}

  // `memory > 500`: `e` is a name.
  void warn_of_bare_function(const syntax::Expression& e);

  // The rest is for a comparison `e`.

  // `battery == nan`, `battery == None`: true, and it was reported.
  bool compares_with_nothing(const syntax::Expression& e);
  // `lifecycle(camera) == active`
  void warn_of_bare_text(const syntax::Expression& e);
  // `entropy > high`. Two names may be two signals of the robot.
  void warn_of_bare_value(const syntax::Expression& e);
  // `level(motors) == ERROR`. False: it was reported.
  bool check_bare_level(const syntax::Expression& e);

 private:
  Symbols& symbols_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace culprit
