#include "bag/sqlite_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <unistd.h>

#include "bag/byte_source.h"

namespace culprit::bag {
namespace {

namespace fs = std::filesystem;

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
  TemporaryCopy copy;  // may go as soon as SQLite has it open
  if (is_compressed(path)) {
    if (const auto done = copy.fill(path); !done) return Error{done.error()};
  }
  auto database = journal::Database::open(copy.path().empty() ? path : fs::path(copy.path()),
                                          journal::Database::Mode::kRead);
  if (!database) return Error{database.error()};
  std::unique_ptr<SqliteFile> file(new SqliteFile(std::move(*database), path.filename(), contents));
  if (const auto begun = file->begin(); !begun)
    return Error{"it is no bag (" + begun.error() + ")"};
  return std::unique_ptr<Storage>(std::move(file));
}

Expected<void> SqliteFile::begin() {
  if (const auto read = read_topics(); !read) return read;
  auto rows =
      database_.prepare("SELECT timestamp, topic_id, data FROM messages ORDER BY timestamp, id");
  if (!rows) return Error{rows.error()};
  rows_ = std::move(*rows);
  // Recorders before Iron did not keep definitions.
  if (auto known = database_.prepare("SELECT topic_type, encoded_message_definition FROM "
                                     "message_definitions WHERE encoding = 'ros2msg'")) {
    while (true) {
      const auto more = known->step();
      if (!more || !*more) break;
      contents_.define(known->bytes(0), known->bytes(1));
    }
  }
  return {};
}

Expected<void> SqliteFile::read_topics() {
  auto rows = database_.prepare("SELECT id, name, type, serialization_format FROM topics");
  if (!rows) return Error{rows.error()};
  while (true) {
    const auto more = rows->step();
    if (!more) return Error{more.error()};
    if (!*more) return {};
    topics_[rows->integer(0)] = contents_.place_of(
        {std::string(rows->bytes(1)), std::string(rows->bytes(2)), std::string(rows->bytes(3))});
  }
}

bool SqliteFile::next(BagMessage& message) {
  while (rows_) {
    const auto more = rows_->step();
    if (!more)
      contents_.lose(name_ + ": what follows its first " + std::to_string(read_) +
                     " messages is lost: " + more.error());
    if (!more || !*more) {
      rows_.reset();
      break;
    }
    ++read_;
    const auto topic = topics_.find(rows_->integer(1));
    if (topic == topics_.end()) {
      contents_.lose_message("of a topic that the file does not describe");
      continue;
    }
    message = {rows_->integer(0), topic->second, rows_->bytes(2)};
    return true;
  }
  return false;
}

}  // namespace culprit::bag
