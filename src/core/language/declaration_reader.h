// The lines that declare something: ROBOT, CYCLE, CONST, COMPONENT, DEPENDENCY, GROUP, IGNORE,
// INTERLOCK, ABORT, DRILL and SIGNAL.
#pragma once

#include <vector>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// Each method reads the line behind its keyword and adds what it declares to `into`. False: the line
// is not understood, and was reported.
class DeclarationReader {
 public:
  DeclarationReader(const Source& source, LineReader& read, syntax::File& into)
      : source_(source), read_(read), into_(into) {}

  bool robot(Scanner& s);
  bool cycle(Scanner& s);
  bool constant(Scanner& s);
  bool component(Scanner& s);
  bool dependency(Scanner& s);
  bool group(Scanner& s);
  bool ignore(Scanner& s);
  bool interlock(Scanner& s);
  bool abort(Scanner& s);
  bool drill(Scanner& s);
  bool signal(Scanner& s);

 private:
  bool on(Scanner& s);
  bool equals_sign(Scanner& s, const syntax::Name& constant);
  bool condition(Scanner& s, std::vector<syntax::Interlock>& all);
  bool assigned_signal(const syntax::Name& name, const Token& sign);
  bool is_status_whole(const Scanner& s, const syntax::Name& status);
  bool is_apart(const Scanner& s);
  bool lacks_one_of_both(const Scanner& s, const syntax::Name& written);
  bool check_field(const Scanner& s, const syntax::Name& field);
  bool signal_source(Scanner& s, syntax::Signal& signal);
  bool publisher(Scanner& s, syntax::Signal& signal);
  bool range(Scanner& s, syntax::Signal& signal);

  const Source& source_;
  LineReader& read_;
  syntax::File& into_;
};

}  // namespace culprit
