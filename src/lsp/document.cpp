#include "lsp/document.h"

namespace culprit::lsp {

Document::Document(std::string text)
    : source("", std::move(text)), checked(check(source, file)), names(occurrences(file)) {}

}  // namespace culprit::lsp
