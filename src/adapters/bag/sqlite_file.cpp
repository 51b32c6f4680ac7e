#include "bag/sqlite_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "bag/byte_source.h"

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRowsOfNames = 100'000;  // topics, or types
constexpr const char* kDisorder = "its rows are out of order";

// Decompressed, for SQLite reads here and there. Gone with its owner.
class TemporaryCopy {
 public:
  TemporaryCopy() = default;
  TemporaryCopy(const TemporaryCopy&) = delete;
  ~TemporaryCopy() {
    std::error_code ignored;
    for (const char* part : {"", "-wal", "-shm"}) {
      if (!path_.empty()) fs::remove(path_ + part, ignored);
    }
  }
  const std::string& path() const { return path_; }

  // Leaves at least half of the free room to others: few bytes can become very many.
  Expected<void> fill(const fs::path& from) {
    auto source = ByteSource::open(from);
    if (!source) return Error{source.error()};
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    std::string name = (folder / "culprit-bag-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0)
      return Error{"it cannot be decompressed into '" + folder.string() +
                   "': " + std::strerror(errno) + "; set TMPDIR to another folder"};
    path_ = name;
    const Expected<void> done = copy(*source, file, fs::space(folder, error).available / 2);
    close(file);
    if (!done) return Error{done.error() + " ('" + folder.string() + "'; set TMPDIR to another)"};
    if (!source->trouble().empty()) return Error{source->trouble()};
    return {};
  }

 private:
  static Expected<void> copy(ByteSource& source, int file, std::uint64_t most) {
    std::string block(std::size_t{1} << 20, '\0');
    while (const std::size_t got = source.read(block.data(), block.size())) {
      if (source.position() > most)
        return Error{"decompressed, it takes more than half of the room for temporary files"};
      for (std::size_t written = 0; written < got;) {
        const ssize_t count = write(file, block.data() + written, got - written);
        if (count < 0) return Error{std::string("it cannot be decompressed: ") + strerror(errno)};
        written += static_cast<std::size_t>(count);
      }
    }
    return {};
  }

  std::string path_;
};

}  // namespace

SqliteFile::SqliteFile(journal::Database database, std::string name, BagContents& contents)
    : database_(std::move(database)), name_(std::move(name)), contents_(contents) {}

Expected<std::unique_ptr<Storage>> SqliteFile::open(const fs::path& path, BagContents& contents) {
  using Mode = journal::Database::Mode;
  TemporaryCopy copy;  // may go as soon as SQLite has it open
  if (is_compressed(path)) {
    if (const auto done = copy.fill(path); !done) return Error{done.error()};
  }
  const fs::path file = copy.path().empty() ? path : fs::path(copy.path());
  std::string why;
  for (const Mode mode : {Mode::kRead, Mode::kSalvage}) {
    auto database = journal::Database::open(file, mode);
    if (!database) {
      if (why.empty()) why = database.error();
      continue;
    }
    std::unique_ptr<SqliteFile> storage(
        new SqliteFile(std::move(*database), path.filename(), contents));
    if (mode == Mode::kSalvage) storage->damage_ = why;
    const auto begun = storage->begin();
    if (begun) return std::unique_ptr<Storage>(std::move(storage));
    if (why.empty()) why = "it is no bag (" + begun.error() + ")";
  }
  return Error{why};
}

Expected<void> SqliteFile::begin() {
  if (const auto read = read_topics(); !read) return read;
  if (auto rows = database_.prepare("SELECT rowid, timestamp, topic_id, data FROM messages"); !rows)
    return Error{rows.error()};
  read_definitions();
  return {};
}

// Recorders before Iron did not keep definitions.
void SqliteFile::read_definitions() {
  auto known = database_.prepare(
      "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = "
      "'ros2msg'");
  for (std::size_t row = 0; known && row < kMostRowsOfNames; ++row) {
    const auto more = known->step();
    if (!more || !*more) return;
    contents_.define(known->bytes(0), known->bytes(1));
  }
}

Expected<void> SqliteFile::read_topics() {
  auto rows = database_.prepare(
      "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics");
  if (!rows)  // recorders before Foxy kept no QoS
    rows = database_.prepare("SELECT id, name, type, serialization_format, '' FROM topics");
  if (!rows) return Error{rows.error()};
  for (std::size_t row = 0; row < kMostRowsOfNames; ++row) {
    const auto more = rows->step();
    if (!more) return Error{more.error()};
    if (!*more) return {};
    topics_[rows->integer(0)] =
        contents_.place_of({std::string(rows->bytes(1)), std::string(rows->bytes(2)),
                            std::string(rows->bytes(3)), std::string(rows->bytes(4))});
  }
  return Error{kDisorder};
}

void SqliteFile::survey(PieceFinder& finder) {
  auto rows = database_.prepare(
      "SELECT rowid, timestamp, topic_id FROM messages NOT INDEXED ORDER BY rowid");
  std::optional<std::int64_t> last;
  while (rows) {
    const auto more = rows->step();
    if (!more && damage_.empty()) damage_ = more.error();
    if (!more || !*more) return;
    const std::int64_t row = rows->integer(0);
    if (last && row <= *last) {
      if (damage_.empty()) damage_ = kDisorder;
      return;
    }
    last = row;
    const std::int64_t at = rows->integer(1);
    if (is_time(at)) finder.add(row, static_cast<std::size_t>(rows->integer(2)), at);
  }
}

void SqliteFile::follow(TimeLine line) {
  line_ = std::move(line);
  if (!damage_.empty()) return begin_salvage();
  if (line_.is_in_file_order) {
    (void)begin_next_stretch();
    return;
  }
  auto rows = database_.prepare(
      "SELECT rowid, timestamp, topic_id, data FROM messages ORDER BY timestamp, rowid");
  if (rows) rows_ = std::move(*rows);
}

// Where the clock was set, what was recorded before it stands before it.
bool SqliteFile::begin_next_stretch() {
  if (!line_.is_in_file_order || stretch_ == line_.stretches.size()) return false;
  auto rows = database_.prepare(
      "SELECT rowid, timestamp, topic_id, data FROM messages WHERE rowid >= ? AND rowid < ? "
      "ORDER BY timestamp, rowid");
  if (!rows) return false;
  constexpr auto kLowest = std::numeric_limits<std::int64_t>::min();
  constexpr auto kHighest = std::numeric_limits<std::int64_t>::max();
  const std::size_t next = stretch_ + 1;
  rows->bind(1, stretch_ == 0 ? kLowest : line_.stretches[stretch_].ordinal)
      .bind(2, next == line_.stretches.size() ? kHighest : line_.stretches[next].ordinal);
  stretch_ = next;
  last_at_.reset();
  rows_ = std::move(*rows);
  return true;
}

// In the order of the rows, since an index may be damaged, too.
void SqliteFile::begin_salvage() {
  is_salvaging_ = true;
  rows_.reset();
  auto rows = database_.prepare(
      "SELECT rowid, timestamp, topic_id, data FROM messages NOT INDEXED WHERE rowid > ? ORDER BY "
      "rowid");
  if (!rows) return;
  rows->bind(1, last_row_);
  rows_ = std::move(*rows);
}

bool SqliteFile::is_readable_after(std::int64_t row) const {
  auto rows = database_.prepare(
      "SELECT rowid, data FROM messages NOT INDEXED WHERE rowid > ? ORDER BY rowid LIMIT 1");
  if (!rows) return false;
  rows->bind(1, row);
  const auto more = rows->step();
  return more && *more && rows->integer(0) > row;
}

// Goes on with the first row behind what cannot be read; false if there is none.
bool SqliteFile::pass_damage() {
  constexpr std::int64_t kFarthest = std::int64_t{1} << 32;
  last_row_ = std::max<std::int64_t>(last_row_, 0);
  std::int64_t high = 1;
  while (high < kFarthest && !is_readable_after(last_row_ + high)) high *= 2;
  if (high >= kFarthest) return false;
  std::int64_t low = high / 2;  // cannot be read
  while (low + 1 < high) {
    const std::int64_t middle = low + (high - low) / 2;
    (is_readable_after(last_row_ + middle) ? high : low) = middle;
  }
  last_row_ += high;
  is_after_hole_ = true;
  begin_salvage();
  return true;
}

// Pages of a damaged database may refer to one another in a loop, which has no end.
bool SqliteFile::is_in_order() const {
  const std::int64_t row = rows_->integer(0);
  if (is_salvaging_) return row > last_row_;
  return !last_at_ || std::pair(rows_->integer(1), row) > std::pair(*last_at_, last_row_);
}

bool SqliteFile::next_row() {
  while (rows_) {
    const auto more = rows_->step();
    if (more && *more && is_in_order()) return true;
    if (more && !*more) {
      if (!is_salvaging_ && begin_next_stretch()) continue;
      break;
    }
    if (!is_salvaging_) {
      if (damage_.empty()) damage_ = more ? kDisorder : more.error();
      begin_salvage();
    } else if (!pass_damage()) {
      break;
    }
  }
  rows_.reset();
  return false;
}

bool SqliteFile::next(BagMessage& message) {
  while (next_row()) {
    ++read_;
    last_row_ = rows_->integer(0);
    const std::int64_t at = rows_->integer(1);
    last_at_ = at;
    const auto topic = topics_.find(rows_->integer(2));
    if (topic == topics_.end()) {
      contents_.lose_message("of a topic that the file does not describe");
      continue;
    }
    message = {is_time(at) ? at + line_.offset_of(last_row_) : at, topic->second, rows_->bytes(3),
               at, is_after_hole_};
    is_after_hole_ = false;
    return true;
  }
  if (!damage_.empty())
    contents_.lose(name_ + ": " + damage_ + "; only " + std::to_string(read_) +
                   " messages were read; try sqlite3 " + name_ + " .recover");
  damage_.clear();
  return false;
}

}  // namespace culprit::bag
