// Reading, writing and replacing whole text files.
#pragma once

#include <string>

#include "language/expected.h"

namespace culprit::cli {

// The bytes of the file at `path`, or of the standard input if it is "-".
// Errors: it cannot be read, or it is larger than a rule file may be.
Expected<std::string> read_text(const std::string& path);

// Writes `text` to a new file, over an old one, or to the standard output if `path` is empty.
Expected<void> write_text(const std::string& path, const std::string& text);

// Puts `text` into the place of the file at `path`: other processes see the old content or the new
// one, whole. Its permissions are kept; behind a symbolic link it is the file that is replaced.
Expected<void> replace_text(const std::string& path, const std::string& text);

}  // namespace culprit::cli
