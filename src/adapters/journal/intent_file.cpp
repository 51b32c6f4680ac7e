#include "journal/intent_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/invariant.h"
#include "journal/bytes.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kIntentMark = "culprit-intents1";
constexpr std::size_t kSizeBytes = 4;
constexpr std::size_t kIntentHead = kIntentMark.size() + 8 + sizeof(Hash);

void write_fixed(std::uint64_t number, std::size_t bytes, char* out) {
  for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<char>(number >> (8 * i));
}

void append_fixed(std::string& out, std::uint64_t number, std::size_t bytes) {
  out.append(bytes, '\0');
  write_fixed(number, bytes, &out[out.size() - bytes]);
}

std::uint64_t fixed_number(std::string_view bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i > 0; --i)
    number = number << 8 | static_cast<unsigned char>(bytes[i - 1]);
  return number;
}

std::string_view view_of(const Hash& hash) {
  return {reinterpret_cast<const char*>(hash.data()), hash.size()};
}

bool may_stand_here(std::string_view kind) {
  return kind == kind::kEvent || kind == kind::kIntent || kind == kind::kOutcome;
}

// False: culprit never writes that, even if the checksum fits.
bool decode_part(std::string_view payload, SavedIntents& saved) {
  ByteReader in(payload);
  const Time step = Time(Duration(in.integer()));
  std::vector<Entry> rows;
  while (in.is_good() && !in.is_at_end()) {
    Entry row;
    row.at = in.integer();
    row.kind = in.text();
    row.body = in.text();
    if (!in.is_good() || !may_stand_here(row.kind)) return false;
    rows.push_back(std::move(row));
  }
  if (!in.is_good()) return false;
  saved.latest = std::max(saved.latest, step);
  for (Entry& row : rows) saved.rows.push_back(std::move(row));
  return true;
}

Error cannot_write_intents(const fs::path& path, const std::string& why) {
  return {"cannot write '" + path.string() + "': " + why};
}

// As the journal's, as SQLite gives them to its own files beside it.
Expected<void> share_permissions(int file, const fs::path& path, const fs::path& journal) {
  struct stat there {};
  struct stat here {};
  if (stat(journal.c_str(), &there) != 0 || fstat(file, &here) != 0)
    return cannot_write_intents(path, std::strerror(errno));
  const mode_t mode = there.st_mode & 0777;
  if ((here.st_mode & 0777) != mode && fchmod(file, mode) != 0)
    return cannot_write_intents(path, std::strerror(errno));
  const bool is_anothers = here.st_uid != there.st_uid || here.st_gid != there.st_gid;
  if (is_anothers && geteuid() == 0 && fchown(file, there.st_uid, there.st_gid) != 0)
    return cannot_write_intents(path, std::strerror(errno));
  return {};
}

}  // namespace

fs::path intents_beside(const fs::path& journal) { return journal.string() + "-intents"; }

void append_row(const Entry& row, std::string& rows) {
  ByteWriter out(rows);
  out.integer(row.at);
  out.text(row.kind);
  out.text(row.body);
}

Expected<IntentFile> IntentFile::open(const fs::path& journal) {
  const fs::path path = intents_beside(journal);
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
    return cannot_write_intents(path, "it is none of culprit's files");
  auto lock = FileLock::take(path);
  if (!lock) return cannot_write_intents(path, lock.error());
  if (!*lock) return cannot_write_intents(path, "another process has it");
  const int file = (*lock)->file();
  if (const auto shared = share_permissions(file, path, journal); !shared)
    return Error{shared.error()};
  if (fstat(file, &status) != 0 || ftruncate(file, 0) != 0)
    return cannot_write_intents(path, std::strerror(errno));
  return IntentFile(path, std::move(**lock), status.st_ino);
}

IntentFile::Head::Head(const Link& newest) : bytes(kIntentMark) {
  append_fixed(bytes, static_cast<std::uint64_t>(newest.id), 8);
  bytes += view_of(newest.hash);
  hash = Hasher().of(bytes);
}

void IntentFile::begin_after(Head head) {
  before_ = head.hash;
  head_ = std::move(head.bytes);
  end_ = 0;
}

Expected<void> IntentFile::append(Time step, std::string_view rows) {
  CULPRIT_ASSERT(head_.size() == kIntentHead);
  bytes_.clear();
  if (end_ == 0) bytes_ = head_;
  const std::size_t part = bytes_.size();
  bytes_.append(kSizeBytes + sizeof(Hash), '\0');
  const std::size_t payload = bytes_.size();
  ByteWriter(bytes_).integer(step.time_since_epoch().count());
  bytes_ += rows;
  const Hash hash = hasher_.of(before_, std::string_view(bytes_).substr(payload));
  write_fixed(bytes_.size() - payload, kSizeBytes, &bytes_[part]);
  bytes_.replace(part + kSizeBytes, sizeof(Hash), view_of(hash));
  append_fixed(bytes_, 0, kSizeBytes);
  if (end_ + bytes_.size() > kMaxBytes)
    return cannot_write_intents(path_, "the journal does not keep up");
  // Writes to a file that somebody removed or replaced would be lost without an error.
  struct stat status {};
  if (stat(path_.c_str(), &status) != 0 || status.st_ino != inode_)
    return cannot_write_intents(path_, "it was removed or replaced");
  const ssize_t written =
      pwrite(file_.file(), bytes_.data(), bytes_.size(), static_cast<off_t>(end_));
  if (written < 0) return cannot_write_intents(path_, std::strerror(errno));
  if (static_cast<std::size_t>(written) != bytes_.size())
    return cannot_write_intents(path_, "the disk is full");
  end_ += bytes_.size() - kSizeBytes;
  before_ = hash;
  return {};
}

void IntentFile::empty() {
  // If the old content stays, the reader finds that the journal has it already.
  if (ftruncate(file_.file(), 0) != 0) return;
  end_ = 0;
}

SavedIntents decode_intents(std::string_view bytes) {
  SavedIntents saved;
  if (bytes.empty()) return saved;
  if (bytes.size() < kIntentHead || !bytes.starts_with(kIntentMark)) {
    saved.damage = "its beginning is damaged";
    return saved;
  }
  saved.after.id = static_cast<std::int64_t>(fixed_number(bytes.substr(kIntentMark.size(), 8)));
  const auto hash = hash_from(bytes.substr(kIntentMark.size() + 8, sizeof(Hash)));
  saved.after.hash = hash.value_or(Hash{});
  Hasher hasher;
  Hash before = hasher.of(bytes.substr(0, kIntentHead));
  std::size_t at = kIntentHead;
  while (true) {
    saved.damage = "it is damaged after byte " + std::to_string(at);
    const std::string_view rest = bytes.substr(at);
    if (rest.size() < kSizeBytes) return saved;
    const std::uint64_t size = fixed_number(rest.substr(0, kSizeBytes));
    if (size == 0) break;
    constexpr std::size_t kPayload = kSizeBytes + sizeof(Hash);
    if (size > IntentFile::kMaxBytes || rest.size() < kPayload + size) return saved;
    const std::string_view payload = rest.substr(kPayload, size);
    const Hash expected = hasher.of(before, payload);
    if (rest.substr(kSizeBytes, sizeof(Hash)) != view_of(expected)) return saved;
    if (!decode_part(payload, saved)) return saved;
    before = expected;
    at += kPayload + size;
  }
  saved.damage.clear();
  return saved;
}

Expected<SavedIntents> read_intents(const fs::path& path) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot read '" + path.string() + "': " + why};
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) {
    if (errno == ENOENT || errno == ENOTDIR) return SavedIntents{};
    return failure(std::strerror(errno));
  }
  std::string bytes(IntentFile::kMaxBytes, '\0');
  std::size_t size = 0;
  struct stat status {};
  const bool is_file = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  ssize_t n = is_file ? 1 : 0;
  while (n > 0 && size < bytes.size()) {
    n = read(file, bytes.data() + size, bytes.size() - size);
    if (n > 0) size += static_cast<std::size_t>(n);
    if (n < 0 && errno == EINTR) n = 1;
  }
  const int reason = errno;
  close(file);
  if (!is_file) return failure("it is none of culprit's files");
  if (n < 0) return failure(std::strerror(reason));
  bytes.resize(size);
  return decode_intents(bytes);
}

}  // namespace culprit::journal
