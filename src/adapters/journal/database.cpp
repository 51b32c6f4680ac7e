#include "journal/database.h"

#include <sqlite3.h>

namespace culprit::journal {
namespace {

constexpr int kBusyMilliseconds = 250;

std::string why(int code, const char* message) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds it locked";
    case SQLITE_FULL:
      return "the disk is full";
    case SQLITE_READONLY:
      return "it may not be written";
    case SQLITE_CANTOPEN:
      return "it cannot be opened; does its folder exist, and may it be written?";
    case SQLITE_CORRUPT:
      return "it is damaged (" + std::string(message) + ")";
    case SQLITE_NOTADB:
      return "it is no journal, or its beginning is damaged";
    default:
      return message;
  }
}

bool is_of_the_file(int code) {
  switch (code & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_ERROR:  // a table is not there, or is another one
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG:
      return true;
    case SQLITE_IOERR:
      return code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ ||
             code == SQLITE_IOERR_CORRUPTFS;
    default:
      return false;
  }
}

// No culprit and no recorder makes them. In a hostile file each row could take a gigabyte.
bool has_computed_columns(const Database& database) {
  const auto count = database.number(
      "SELECT count(*) FROM sqlite_schema AS t, pragma_table_xinfo(t.name) AS c "
      "WHERE t.type = 'table' AND c.hidden = 2");
  return count && *count > 0;
}

// As a URI, in which '?', '#' and '%' would mean something.
std::string uri_of(const std::filesystem::path& path, const char* query) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    constexpr char kDigits[] = "0123456789ABCDEF";
    if (c == '?' || c == '#' || c == '%') {
      uri += '%';
      uri += kDigits[static_cast<unsigned char>(c) >> 4];
      uri += kDigits[static_cast<unsigned char>(c) & 15];
    } else {
      uri += c;
    }
  }
  return uri + query;
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement& Statement::bind(int place, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), place, value);
  return *this;
}

Statement& Statement::bind(int place, double value) {
  sqlite3_bind_double(statement_.get(), place, value);
  return *this;
}

Statement& Statement::bind(int place, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), place, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}

Statement& Statement::bind_blob(int place, std::string_view bytes) {
  sqlite3_bind_blob64(statement_.get(), place, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  return *this;
}

Expected<bool> Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  sqlite3* connection = sqlite3_db_handle(statement_.get());
  const std::string message = sqlite3_errmsg(connection);
  const int extended = sqlite3_extended_errcode(connection);
  sqlite3_reset(statement_.get());
  if (code == SQLITE_DONE) return false;
  *blames_file_ = is_of_the_file(extended);
  return Error{why(code, message.c_str())};
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const { return sqlite3_column_double(statement_.get(), column); }

std::string_view Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return data == nullptr
             ? std::string_view()
             : std::string_view(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

void Database::Close::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Expected<Database> Database::open(const std::filesystem::path& path, Mode mode) {
  const auto attempt = [&](const char* query) -> Expected<Database> {
    sqlite3* connection = nullptr;
    const int flags =
        mode == Mode::kWrite ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
    const int code = sqlite3_open_v2(uri_of(path, query).c_str(), &connection,
                                     flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    Database database(connection);
    if (code != SQLITE_OK) return Error{why(code, sqlite3_errmsg(connection))};
    sqlite3_extended_result_codes(connection, 1);
    sqlite3_busy_timeout(connection, kBusyMilliseconds);
    sqlite3_db_config(connection, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(connection, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    if (mode == Mode::kSalvage) (void)database.run("PRAGMA writable_schema = ON");
    // Whether it can be read shows with the first look only.
    if (const auto look = database.number("SELECT count(*) FROM sqlite_schema"); !look)
      return Error{look.error()};
    if (mode != Mode::kWrite && has_computed_columns(database))
      return Error{"it has computed columns, whose rows may take any memory and time"};
    return database;
  };
  auto opened = attempt("");
  if (opened || mode == Mode::kWrite || !std::filesystem::exists(path)) return opened;
  auto unshared = attempt("?immutable=1");
  return unshared ? std::move(unshared) : std::move(opened);
}

Expected<void> Database::run(const std::string& sql) {
  if (sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK)
    return {};
  return error();
}

void Database::roll_back() {
  sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Expected<Statement> Database::prepare(std::string_view sql) const {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(connection_.get(), sql.data(), static_cast<int>(sql.size()),
                                      &statement, nullptr);
  if (code != SQLITE_OK) return error();
  return Statement(statement, blames_file_.get());
}

Expected<std::int64_t> Database::number(const std::string& sql) const {
  auto statement = prepare(sql);
  if (!statement) return Error{statement.error()};
  const auto row = statement->step();
  if (!row) return Error{row.error()};
  return *row ? statement->integer(0) : 0;
}

bool Database::is_damaged(const std::filesystem::path& path, std::span<const char* const> looks) {
  sqlite3* connection = nullptr;
  int code = sqlite3_open_v2(uri_of(path, "").c_str(), &connection,
                             SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  const Database database(connection);
  if (connection != nullptr) {
    sqlite3_extended_result_codes(connection, 1);
    sqlite3_busy_timeout(connection, kBusyMilliseconds);
  }
  for (const char* look : looks) {
    if (code == SQLITE_OK) code = sqlite3_exec(connection, look, nullptr, nullptr, nullptr);
  }
  return code != SQLITE_OK && is_of_the_file(code);
}

Expected<std::filesystem::path> Database::set_aside(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  fs::path aside;
  for (int n = 1; aside.empty() || fs::exists(aside); ++n)
    aside = path.string() + ".damaged-" + std::to_string(n);
  std::error_code error;
  for (const char* part : {"-wal", "-shm"})
    fs::rename(path.string() + part, aside.string() + part, error);
  fs::rename(path, aside, error);
  if (error) return Error{error.message()};
  return aside;
}

Error Database::error() const {
  const int code = sqlite3_extended_errcode(connection_.get());
  *blames_file_ = is_of_the_file(code);
  return {why(code, sqlite3_errmsg(connection_.get()))};
}

}  // namespace culprit::journal
