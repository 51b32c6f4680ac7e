// The answers to requests about one document: what is proposed, shown, found and changed at a place of it. Each is the
// result of the LSP request of its name; `params` are those of the request.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "json/json.h"
#include "lsp/document.h"

namespace culprit::lsp {

// A document as its client knows it, and the robot beside it; null: none was seen.
struct Asked {
  const std::string& uri;
  const Document& document;
  const Json& params;
  const LiveInventory* robot;
};

constexpr const char* kQuickFix = "quickfix";  // CodeActionKind
// The types by which editors colour names; the order is that of Occurrence::Kind.
inline constexpr std::array kTokenTypes = {
    "enumMember", "class",  "variable", "string", "property",  "namespace", "method",
    "function",   "string", "string",   "macro",  "parameter", "string"};

// `includable`: gives the files that the document may include.
Json completion(const Asked& asked, const std::function<std::vector<std::string>()>& includable);
Json hover(const Asked& asked);
// `load`: gives a file that the document includes.
Json definition(const Asked& asked,
                const std::function<Expected<Source>(const std::string& file)>& load);
Json references(const Asked& asked);
// Errors: for people.
Expected<Json> rename(const Asked& asked);
Json formatting(const Asked& asked);
Json code_actions(const Asked& asked);
Json symbols(const Asked& asked);
Json semantic_tokens(const Asked& asked);

}  // namespace culprit::lsp
