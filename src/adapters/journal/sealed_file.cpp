#include "journal/sealed_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sys/stat.h>

#include "base/text_file.h"
#include "journal/entry.h"

namespace culprit::journal {
namespace {

constexpr std::string_view kMark = "culprit-sealed 1 ";
// Larger than any that culprit writes: what is not ours is not read into memory.
constexpr off_t kLargest = 64 << 20;

std::string head_of(std::string_view text) {
  return std::string(kMark) + to_hex(Hasher().of(text)) + "\n";
}

}  // namespace

Expected<void> write_sealed(const std::filesystem::path& path, const std::string& text) {
  return write_text(path.string(), head_of(text) + text);
}

Expected<std::optional<std::string>> read_sealed(const std::filesystem::path& path) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot read '" + path.string() + "': " + why};
  };
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return std::optional<std::string>();
    return failure(std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode) || status.st_size > kLargest)
    return failure("it is none of culprit's files");
  std::ifstream file(path, std::ios::binary);
  if (!file) return failure(std::strerror(errno));
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end = all.find('\n');
  std::string text = end == std::string::npos ? "" : all.substr(end + 1);
  if (file.bad() || end == std::string::npos || all.substr(0, end + 1) != head_of(text))
    return failure("it is damaged");
  return std::optional(std::move(text));
}

}  // namespace culprit::journal
