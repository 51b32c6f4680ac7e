// Reads a journal file, also while another process writes it. Changes nothing.
//
//     const auto reader = Reader::open("/var/lib/culprit/robot.journal");
//     auto rows = reader->entries(Which::kReadable);
//     for (Entry row; *rows->next(row);) std::puts(row.body.c_str());
#pragma once

#include <filesystem>
#include <optional>

#include "journal/database.h"
#include "journal/entry.h"
#include "journal/learned.h"
#include "journal/tables.h"

namespace culprit::journal {

enum class Which : std::uint8_t { kAll, kReadable };  // kReadable: all but `steps`

// The rows, one by one. Must not outlive its reader.
class Cursor {
 public:
  // False at the end. Reuses the memory of `entry`.
  Expected<bool> next(Entry& entry);
  // The hash of the row that next() returned.
  std::string_view hash() const { return statement_.bytes(4); }
  // Whether its hash fits its content and the row before: rows that cause an action must pass.
  bool is_as_written(const Entry& entry, Hasher& hasher) const;

 private:
  friend class Reader;
  explicit Cursor(Statement statement) : statement_(std::move(statement)) {}
  Statement statement_;
};

class Reader {
 public:
  // Errors say why, with the path.
  static Expected<Reader> open(const std::filesystem::path& path);
  // For one's own file. `database` is a journal.
  explicit Reader(Database database) : database_(std::move(database)) {}

  // From row `from` on, in order.
  Expected<Cursor> entries(Which which, std::int64_t from = 1) const;
  Expected<std::optional<Entry>> entry(std::int64_t id) const;

  // The newest row of this kind; the newest before row `before` if that is not 0.
  Expected<std::optional<Entry>> newest(std::string_view kind, std::int64_t before = 0) const;

  // So that at most `count` readable rows come from there on.
  Expected<std::int64_t> tail(std::int64_t count) const;

  Expected<Learned> learned() const { return read_learned(database_); }
  Expected<Link> newest_link() const { return journal::newest_link(database_); }
  Expected<Link> anchor() const { return journal::anchor(database_); }
  const Database& database() const { return database_; }

 private:
  Database database_;
};

}  // namespace culprit::journal
