// Positions, ranges, diagnostics and URIs as LSP 3.17 sends them, and the parts of a client's message. It may have any shape.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "json/json.h"
#include "language/diagnostic.h"
#include "lsp/document.h"
#include "lsp/text_position.h"

namespace culprit::lsp {

// The value at a path of members; null if it is not there.
using JsonPath = std::initializer_list<const char*>;
const Json* at(const Json& value, const JsonPath& path);
std::string text_at(const Json& value, const JsonPath& path);

// The offset of the position in `params` that `path` leads to.
std::uint32_t place_in(const Document& document, const Json& params,
                       const JsonPath& path = {"position"});

Json to_json(const Source& source, Span span);
Json to_json(const Diagnostic& diagnostic, const Source& source);

// file:///a%20b.rules -> /a b.rules; empty for what is no file.
std::string path_of(const std::string& uri);
// As VS Code writes them: an editor knows its documents by what it called them.
std::string uri_of(const std::string& path);

}  // namespace culprit::lsp
