// A folder of its own for files that a moment needs.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "base/expected.h"

namespace culprit {

// Removes the folder, with all that is in it, when it is destroyed. Only its owner may read it.
class TemporaryFolder {
 public:
  // In the system's folder for temporary files (TMPDIR, or /tmp): "culprit-<purpose>-" and six random characters.
  // Errors: it cannot be made there, as on a full disk.
  static Expected<TemporaryFolder> make(const std::string& purpose);

  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ~TemporaryFolder();

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty: moved from
};

}  // namespace culprit
