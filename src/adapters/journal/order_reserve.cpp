#include "journal/order_reserve.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>

#include "base/invariant.h"
#include "journal/sealed_file.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRecord = 16 << 10;  // bytes
constexpr std::size_t kRecords = 2;

Error cannot_use_reserve(const fs::path& path, const std::string& why) {
  return {"cannot write '" + path.string() + "': " + why};
}

struct Record {
  std::uint64_t number = 0;
  std::string text;
};

class ReserveFile {
 public:
  ReserveFile(const fs::path& path, int flags)
      : file_(open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0600)) {
    struct stat status {};
    if (file_ < 0 || fstat(file_, &status) != 0) return;
    is_whole_ = S_ISREG(status.st_mode) && status.st_size == static_cast<off_t>(kRecord * kRecords);
    is_ours_ = S_ISREG(status.st_mode);
  }
  ReserveFile(const ReserveFile&) = delete;
  ~ReserveFile() {
    if (file_ >= 0) close(file_);
  }
  bool is_ours() const { return is_ours_; }
  bool is_whole() const { return is_whole_; }

  // Nothing: it is damaged, or was never written.
  std::optional<Record> record(std::size_t which) const {
    std::string bytes(kRecord, '\0');
    const ssize_t size =
        pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(which * kRecord));
    if (size <= 0) return std::nullopt;
    bytes.resize(static_cast<std::size_t>(size));
    bytes.resize(std::min(bytes.find('\0'), bytes.size()));
    const auto content = unsealed(bytes);
    if (!content) return std::nullopt;
    Record record;
    const char* const end = content->data() + content->size();
    const auto [rest, error] = std::from_chars(content->data(), end, record.number);
    if (error != std::errc() || rest == end || *rest != '\n') return std::nullopt;
    record.text.assign(rest + 1, end);
    return record;
  }
  // Which record is the newest; nothing: none is whole.
  std::optional<std::size_t> newest() const {
    const auto first = record(0);
    const auto second = record(1);
    if (!first && !second) return std::nullopt;
    return first && (!second || first->number > second->number) ? 0 : 1;
  }

  bool write(std::size_t which, std::string bytes) const {
    CULPRIT_ASSERT(which < kRecords && bytes.size() < kRecord);
    bytes.resize(kRecord, '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t written = pwrite(file_, bytes.data() + done, bytes.size() - done,
                                     static_cast<off_t>(which * kRecord + done));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      done += static_cast<std::size_t>(written);
    }
    return true;
  }
  bool sync() const { return fdatasync(file_) == 0; }

 private:
  int file_;
  bool is_ours_ = false;   // a regular file
  bool is_whole_ = false;  // of the size that it has once it was filled
};

// Written, not only allocated: to write over allocated blocks for the first time can need room, too.
Expected<void> fill(const fs::path& path) {
  const ReserveFile file(path, O_RDWR | O_CREAT);
  if (!file.is_ours()) return cannot_use_reserve(path, "it is none of culprit's files");
  for (std::size_t i = 0; i < kRecords; ++i) {
    if (!file.write(i, "")) return cannot_use_reserve(path, std::strerror(errno));
  }
  if (!file.sync()) return cannot_use_reserve(path, std::strerror(errno));
  return {};
}

}  // namespace

fs::path reserve_beside(const fs::path& orders) { return orders.string() + "-reserve"; }

Expected<void> make_reserve(const fs::path& reserve) {
  if (ReserveFile(reserve, O_RDONLY).is_whole()) return {};
  return fill(reserve);
}

Expected<void> clear_reserve(const fs::path& reserve) { return fill(reserve); }

Expected<void> write_reserve(const fs::path& reserve, const std::string& text) {
  const ReserveFile file(reserve, O_RDWR);
  if (!file.is_whole()) return cannot_use_reserve(reserve, "its room was not taken beforehand");
  const auto newest = file.newest();
  const std::uint64_t number = newest ? file.record(*newest)->number + 1 : 1;
  std::string bytes = sealed(std::to_string(number) + "\n" + text);
  if (bytes.size() >= kRecord) return cannot_use_reserve(reserve, "the orders are too long");
  if (!file.write(newest == 0u ? 1 : 0, std::move(bytes)) || !file.sync())
    return cannot_use_reserve(reserve, std::strerror(errno));
  return {};
}

std::optional<std::string> read_reserve(const fs::path& reserve) {
  const ReserveFile file(reserve, O_RDONLY);
  const auto newest = file.is_whole() ? file.newest() : std::nullopt;
  if (!newest) return std::nullopt;
  return file.record(*newest)->text;
}

}  // namespace culprit::journal
