#include "cli/text_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sys/stat.h>
#include <unistd.h>

#include "language/source.h"

namespace culprit::cli {
namespace {

Error failure(const std::string& what, const std::string& path) {
  return {"cannot " + what + " '" + path + "': " + std::strerror(errno)};
}

Expected<std::string> read_all(std::istream& in, const std::string& path) {
  std::string text;
  char block[1 << 16];
  while (in.read(block, sizeof block) || in.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > Source::kMaxSize)
      return Error{"'" + path + "' is larger than 64 MiB; is it a rule file?"};
  }
  if (in.bad() || !in.eof()) return Error{"cannot read '" + path + "': is it a directory?"};
  return text;
}

bool write_all(int file, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(file, text.data() + written, text.size() - written);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) written += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

Expected<std::string> read_text(const std::string& path) {
  if (path == "-") return read_all(std::cin, "standard input");
  std::ifstream file(path, std::ios::binary);
  if (!file) return failure("read", path);
  return read_all(file, path);
}

Expected<void> write_text(const std::string& path, const std::string& text) {
  std::FILE* file = path.empty() ? stdout : std::fopen(path.c_str(), "wb");
  if (file == nullptr) return failure("write", path);
  const bool is_written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool is_flushed = (path.empty() ? std::fflush(file) : std::fclose(file)) == 0;
  if (is_written && is_flushed) return {};
  return failure("write", path.empty() ? "the standard output" : path);
}

Expected<void> replace_text(const std::string& path, const std::string& text) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  struct stat old {};
  if (error || stat(target.c_str(), &old) != 0) return failure("find", path);
  // In the same folder, so that the rename stays within one file system.
  std::string temporary = target.parent_path() / ("." + target.filename().string() + ".XXXXXX");
  const int file = mkstemp(temporary.data());
  if (file < 0) return failure("write beside", path);
  // On the disk before the name points to it: a power failure leaves one of the two contents.
  const bool written =
      write_all(file, text) && fchmod(file, old.st_mode & 07777) == 0 && fsync(file) == 0;
  const int reason = errno;
  const bool closed = close(file) == 0;
  if (written && closed && rename(temporary.c_str(), target.c_str()) == 0) return {};
  if (!written) errno = reason;
  const Error what = failure("write", path);
  unlink(temporary.c_str());
  return what;
}

}  // namespace culprit::cli
