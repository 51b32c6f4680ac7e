// One open rule file: its text, its declarations, and its diagnostics.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "language/checker.h"
#include "language/live_inventory.h"
#include "language/occurrences.h"
#include "language/parser.h"
#include "language/reuse/expansion.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit::lsp {

struct Document {
  // `name` is what messages and `load` call it; it may be empty.
  explicit Document(std::string text, const std::string& name = "",
                    const RuleLoader& load = nullptr);

  // Its text is another one now. All is as of a Document that is made of it.
  void change(std::string text, const RuleLoader& load);

  // The component of this name: as the rules declare it, or the node of this name.
  Component component_called(const std::string& name) const;
  // Every place that names something, found when it is first asked for: not at each keystroke.
  const std::vector<Occurrence>& names() const;
  // Declarations of included files and templates, under their names in these rules. Their spans are
  // of `rules.source`.
  const std::vector<Occurrence>& names_elsewhere() const;
  // Checks against the robot too, from now on. False if that changes nothing.
  bool compare_with(const LiveInventory& robot);

  const Source& source() const { return written_.source; }
  const syntax::File& file() const { return written_.file; }
  Expansion rules;  // with all that the file includes and uses put in
  Checked checked;  // its diagnostics are of `rules`
  // Diagnostics of the file itself. A mistake in an included file is shown at the INCLUDE, and in
  // that file.
  std::vector<Diagnostic> diagnostics;
  std::map<std::uint32_t, std::vector<Diagnostic>> elsewhere;  // by the file of rules.source

 private:
  void read_rules(const RuleLoader& load);
  void tell(const std::vector<Diagnostic>& found);

  Parsed written_;
  std::optional<Parsed> whole_;  // of rules.source; nothing: the file is whole
  mutable std::optional<std::vector<Occurrence>> names_;
  mutable std::optional<std::vector<Occurrence>> names_elsewhere_;
};

}  // namespace culprit::lsp
