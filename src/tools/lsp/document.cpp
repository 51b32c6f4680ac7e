#include "lsp/document.h"

#include "language/live_checks.h"
#include "language/parser.h"

namespace culprit::lsp {

Document::Document(std::string text) : source("", std::move(text)) {
  std::vector<Diagnostic> said;
  file = parse(source, said);
  checked = check(file, std::move(said));
  diagnostics = checked.diagnostics;
}

Component Document::component_called(const std::string& name) const {
  for (const syntax::Component& c : file.components) {
    if (c.name.text == name) return {name, c.node ? c.node->text : "", {}, true};
  }
  return {name, name.starts_with('/') ? name : "", {}, false};
}

const std::vector<Occurrence>& Document::names() const {
  if (!names_) names_ = occurrences(file);
  return *names_;
}

bool Document::compare_with(const LiveInventory& robot) {
  std::vector<Diagnostic> all = checked.diagnostics;
  // A robot without any node is one that is not there, and says nothing about the rules.
  if (checked.rules && !robot.nodes.empty()) check_live(file, *checked.rules, robot, all);
  if (all == diagnostics) return false;
  diagnostics = std::move(all);
  return true;
}

}  // namespace culprit::lsp
