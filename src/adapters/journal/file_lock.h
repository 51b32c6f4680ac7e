// A file that one process has to itself, until it ends, however it ends.
#pragma once

#include <filesystem>
#include <optional>

#include "base/expected.h"

namespace culprit::journal {

class FileLock {
 public:
  // Nothing: another process has it. Errors: the file cannot be made.
  static Expected<std::optional<FileLock>> take(const std::filesystem::path& path);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

  // Its descriptor, for code that also reads or writes the file.
  int file() const { return file_; }

 private:
  explicit FileLock(int file) : file_(file) {}
  int file_;  // -1 after a move
};

}  // namespace culprit::journal
