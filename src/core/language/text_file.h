// Reading and writing whole text files.
#pragma once

#include <string>

#include "language/expected.h"

namespace culprit {

// The bytes of the file at `path`, or of the standard input if it is "-".
// Errors: it cannot be read, or it is larger than a rule file may be.
Expected<std::string> read_text(const std::string& path);

// Makes `text` the content of the file at `path`, which may be new, or writes it to the standard
// output if `path` is empty. Of a file, other processes see the old content or the new one, whole;
// its permissions are kept; behind a symbolic link it is the file that is replaced.
Expected<void> write_text(const std::string& path, const std::string& text);

}  // namespace culprit
