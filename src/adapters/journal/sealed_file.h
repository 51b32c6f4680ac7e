// A small file that shows whether it was damaged: a checksum precedes the text. It is replaced as a
// whole, so a crash or a power failure leaves one content or the other.
//
//     culprit-sealed 1 <SHA-256 of the text, hexadecimal>\n
//     text
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/expected.h"

namespace culprit::journal {

// As such a file holds it. And back; nothing: it is not as it was written.
std::string sealed(const std::string& text);
std::optional<std::string> unsealed(const std::string& content);

// On the disk, with its name, when this returns. Errors name the file.
Expected<void> write_sealed(const std::filesystem::path& path, const std::string& text);

// Nothing: there is no such file. Errors, with the path: it cannot be read, or is not as it was
// written.
Expected<std::optional<std::string>> read_sealed(const std::filesystem::path& path);

}  // namespace culprit::journal
