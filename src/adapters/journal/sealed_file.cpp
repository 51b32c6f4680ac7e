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
// Larger than any that culprit writes: other files are not read into memory.
constexpr off_t kLargest = 64 << 20;

std::string head_of(std::string_view text) {
  return std::string(kMark) + to_hex(Hasher().of(text)) + "\n";
}

}  // namespace

std::string sealed(const std::string& text) { return head_of(text) + text; }

std::optional<std::string> unsealed(const std::string& content) {
  const std::size_t end = content.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string text = content.substr(end + 1);
  if (content.compare(0, end + 1, head_of(text)) != 0) return std::nullopt;
  return text;
}

Expected<void> write_sealed(const std::filesystem::path& path, const std::string& text) {
  return write_text(path.string(), sealed(text));
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
  auto text = unsealed(all);
  if (file.bad() || !text) return failure("it is damaged");
  return text;
}

}  // namespace culprit::journal
