// Messages of the Language Server Protocol on a byte stream (LSP 3.17, "Base Protocol"): a header
// with the length, an empty line, and so many bytes of JSON.
#pragma once

#include <istream>
#include <optional>
#include <ostream>

#include "base/expected.h"
#include "json/json.h"

namespace culprit::lsp {

// The largest message that is read, in bytes.
inline constexpr std::size_t kMaxMessage = 128u << 20;

// The next message; nothing at the end of the stream. Invalid JSON comes as a discarded value
// (Json::is_discarded). An error: the stream is no sequence of messages, and cannot be read on.
Expected<std::optional<Json>> read_message(std::istream& in);

void write_message(std::ostream& out, const Json& message);

}  // namespace culprit::lsp
