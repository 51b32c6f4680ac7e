#include "base/text_file.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

namespace culprit {
namespace {

Error failure(const std::string& what, const std::filesystem::path& path) {
  const int reason = errno;
  const std::filesystem::path folder = path.parent_path();
  std::error_code unknown;
  const bool lacks_folder =
      reason == ENOENT && !folder.empty() && !std::filesystem::exists(folder, unknown);
  return {"cannot " + what + " '" + path.string() + "': " +
          (lacks_folder ? "there is no folder '" + folder.string() + "'" : std::strerror(reason))};
}

Expected<std::string> read_all(std::istream& in, const std::string& path) {
  std::string text;
  char block[1 << 16];
  while (in.read(block, sizeof block) || in.gcount() > 0) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMaxTextSize) return Error{"'" + path + "' is larger than 64 MiB"};
  }
  if (in.bad() || !in.eof()) return Error{"cannot read '" + path + "': is it a directory?"};
  return text;
}

// umask(2) returns the mask only by setting another one, and other threads make files meanwhile.
mode_t mode_of_new_files() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    constexpr std::string_view kMask = "Umask:";
    if (line.starts_with(kMask))
      return 0666 & ~static_cast<mode_t>(std::strtoul(line.c_str() + kMask.size(), nullptr, 8));
  }
  return S_IRUSR | S_IWUSR;
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

Expected<void> write_through(const std::filesystem::path& target, const std::string& text) {
  std::ofstream file(target, std::ios::binary);
  file << text << std::flush;
  return file ? Expected<void>() : failure("write", target);
}

// A name is on the disk when its folder is.
Expected<void> sync_folder(const std::filesystem::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return failure("write", folder);
  const bool synced = fsync(file) == 0 || errno == EINVAL;  // not every file system can
  const int reason = errno;
  close(file);
  if (synced) return {};
  errno = reason;
  return failure("write", folder);
}

Expected<void> replace(const std::filesystem::path& target, const std::string& text, mode_t mode) {
  // In the same folder, so that the rename stays within one file system.
  std::string temporary = target.parent_path() / ("." + target.filename().string() + ".XXXXXX");
  const int file = mkstemp(temporary.data());
  if (file < 0) return failure("write beside", target);
  // On the disk before the name points to it: a power failure leaves one of the two contents.
  const bool written = write_all(file, text) && fchmod(file, mode) == 0 && fsync(file) == 0;
  const int reason = errno;
  const bool closed = close(file) == 0;
  if (written && closed && rename(temporary.c_str(), target.c_str()) == 0)
    return sync_folder(target.parent_path());
  if (!written) errno = reason;
  const Error what = failure("write", target);
  unlink(temporary.c_str());
  return what;
}

}  // namespace

Expected<std::string> read_text(const std::string& path) {
  if (path == "-") return read_all(std::cin, "standard input");
  std::ifstream file(path, std::ios::binary);
  if (!file) return failure("read", path);
  return read_all(file, path);
}

Expected<void> write_text(const std::string& path, const std::string& text) {
  if (path.empty()) {
    std::cout << text << std::flush;
    return std::cout ? Expected<void>() : failure("write", "the standard output");
  }
  std::error_code error;
  // Whole: of a file that is not there yet a relative name stays as it is, and has no folder.
  const std::filesystem::path target =
      std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  if (error) return Error{"cannot find '" + path + "': " + error.message()};
  const auto status = std::filesystem::status(target, error);
  const bool is_new = status.type() == std::filesystem::file_type::not_found;
  if (!is_new && status.type() != std::filesystem::file_type::regular)
    return write_through(target, text);  // a device or a pipe: nothing to replace
  const auto mode = is_new ? mode_of_new_files() : static_cast<mode_t>(status.permissions());
  return replace(target, text, mode);
}

}  // namespace culprit
