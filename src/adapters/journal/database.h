// SQLite with owners and errors as values.
//
// A Database is one connection, used by one thread at a time. Statements must not outlive it. Views are refused: a file of somebody
// else may have one without an end in place of a table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/expected.h"

struct sqlite3;
struct sqlite3_stmt;

namespace culprit::journal {

class Statement {
 public:
  Statement(Statement&&) noexcept = default;
  Statement& operator=(Statement&&) noexcept = default;

  // Places are counted from 1. Texts and blobs are copied.
  Statement& bind(int place, std::int64_t value);
  Statement& bind(int place, double value);
  Statement& bind(int place, std::string_view text);
  Statement& bind_blob(int place, std::string_view bytes);

  // Moves to the next row; false at the end. After the end, and after an error, the statement can
  // be bound and stepped again.
  Expected<bool> step();

  // The columns of the present row, from 0. Texts and blobs are valid until the next step.
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string_view bytes(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement(sqlite3_stmt* statement, bool* blames_file)
      : statement_(statement), blames_file_(blames_file) {}

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  bool* blames_file_;  // of the database
};

class Database {
 public:
  enum class Mode : std::uint8_t { kRead, kWrite, kSalvage };

  // kWrite makes the file if it is not there. kRead also reads where nothing may be written (the
  // folder of a file in WAL mode), unless another process is writing. kSalvage reads a file whose
  // schema names tables or indexes that are damaged, of which then only the others can be read.
  static Expected<Database> open(const std::filesystem::path& path, Mode mode);

  Expected<void> run(const std::string& sql);
  // Ends a transaction that failed; SQLite may have done so already.
  void roll_back();
  Expected<Statement> prepare(std::string_view sql) const;

  // The one number that `sql` selects.
  Expected<std::int64_t> number(const std::string& sql) const;

  // Whether the last failure is due to the file's content: it is broken, cannot be read, or is not
  // what it should be. False if something else was in the way: the disk is full, the file is locked
  // or may not be written.
  bool blames_file() const { return *blames_file_; }

  // As blames_file(), for a file that cannot be opened, or in which one of `looks` fails.
  static bool is_damaged(const std::filesystem::path& path, std::span<const char* const> looks);
  // Moves a file and what SQLite keeps beside it to the first free name, "<path>.damaged-<n>".
  static Expected<std::filesystem::path> set_aside(const std::filesystem::path& path);

 private:
  struct Close {
    void operator()(sqlite3* connection) const;
  };
  explicit Database(sqlite3* connection)
      : connection_(connection), blames_file_(std::make_unique<bool>(false)) {}
  Error error() const;

  std::unique_ptr<sqlite3, Close> connection_;
  std::unique_ptr<bool> blames_file_;  // also written by statements
};

}  // namespace culprit::journal
