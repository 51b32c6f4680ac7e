// Reading and writing whole text files.
#pragma once

#include <cstddef>
#include <string>

#include "base/expected.h"

namespace culprit {

// Larger files are not read, in bytes: no text that people write is.
inline constexpr std::size_t kMaxTextSize = 64u << 20;

// The bytes of the file at `path`, or of the standard input if it is "-".
// Errors: it cannot be read, or it is larger than kMaxTextSize.
Expected<std::string> read_text(const std::string& path);

// Makes `text` the content of the file at `path`, which may be new, or writes it to the standard
// output if `path` is empty. Other processes see the whole old content of the file or the whole new
// one. The file keeps its permissions; if `path` is a symbolic link, the file behind it is
// replaced.
Expected<void> write_text(const std::string& path, const std::string& text);

}  // namespace culprit
