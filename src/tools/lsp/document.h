// One open rule file: its text, what it says, and what is wrong with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "language/checker.h"
#include "language/live_inventory.h"
#include "language/occurrences.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit::lsp {

struct Document {
  explicit Document(std::string text);

  // The component of this name: as the file declares it, or the node of this name.
  Component component_called(const std::string& name) const;
  // Every place that names something, found when it is first asked for: not at each keystroke.
  const std::vector<Occurrence>& names() const;
  // Checks against the robot too, from now on. False if that changes nothing.
  bool compare_with(const LiveInventory& robot);

  Source source;
  syntax::File file;
  Checked checked;
  std::vector<Diagnostic> diagnostics;  // of the check, and of the robot

 private:
  mutable std::optional<std::vector<Occurrence>> names_;
};

}  // namespace culprit::lsp
