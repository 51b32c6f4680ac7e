// A file of a bag in SQLite3 storage (rosbag2_storage_sqlite3).
//
// Rows have ascending numbers in the order in which they were written. A damaged file is read in
// that order, past the pages that cannot be read.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_map>

#include "bag/storage.h"
#include "journal/database.h"

namespace culprit::bag {

class SqliteFile : public Storage {
 public:
  // `contents` must outlive the file. One that is compressed is decompressed into the folder for
  // temporary files. Errors: it cannot be opened, is no bag, or there is no room for it.
  static Expected<std::unique_ptr<Storage>> open(const std::filesystem::path& path,
                                                 BagContents& contents);

  void survey(PieceFinder& finder) override;
  void follow(TimeLine line) override;
  bool next(BagMessage& message) override;

 private:
  SqliteFile(journal::Database database, std::string name, BagContents& contents);
  Expected<void> read_topics();
  Expected<void> begin();
  void read_definitions();
  bool next_row();
  bool is_in_order() const;
  bool begin_next_stretch();
  void begin_salvage();
  bool pass_damage();
  bool is_readable_after(std::int64_t row) const;

  journal::Database database_;
  std::string name_;
  BagContents& contents_;
  std::unordered_map<std::int64_t, std::size_t> topics_;  // its number -> ours
  TimeLine line_;
  std::size_t stretch_ = 0;  // that is read next, where they are read one after the other
  std::optional<journal::Statement> rows_;
  std::string damage_;  // what SQLite said of it; empty: it is whole as far as is known
  bool is_salvaging_ = false;
  std::optional<std::int64_t> last_at_;  // of the rows that are read now
  std::int64_t last_row_ = std::numeric_limits<std::int64_t>::min();
  bool is_after_hole_ = false;
  std::uint64_t read_ = 0;
};

}  // namespace culprit::bag
