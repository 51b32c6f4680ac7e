#include "lsp/document.h"

#include "language/parser.h"

namespace culprit::lsp {

Document::Document(std::string text) : source("", std::move(text)), checked(check(source)) {
  std::vector<Diagnostic> already_in_checked;
  file = parse(source, already_in_checked);
  names = occurrences(file);
}

}  // namespace culprit::lsp
