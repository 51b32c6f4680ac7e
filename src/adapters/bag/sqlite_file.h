// A file of a bag in SQLite3 storage (rosbag2_storage_sqlite3).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <unordered_map>

#include "bag/bag_contents.h"
#include "journal/database.h"

namespace culprit::bag {

class SqliteFile : public Storage {
 public:
  // `contents` must outlive the file. One that is compressed is decompressed into the folder for
  // temporary files. Errors: it cannot be opened, is no bag, or there is no room for it.
  static Expected<std::unique_ptr<Storage>> open(const std::filesystem::path& path,
                                                 BagContents& contents);

  bool next(BagMessage& message) override;

 private:
  SqliteFile(journal::Database database, std::string name, BagContents& contents);
  Expected<void> read_topics();
  Expected<void> begin();

  journal::Database database_;
  std::string name_;
  BagContents& contents_;
  std::unordered_map<std::int64_t, std::size_t> topics_;  // its number -> ours
  std::optional<journal::Statement> rows_;
  std::uint64_t read_ = 0;
};

}  // namespace culprit::bag
