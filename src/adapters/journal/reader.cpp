#include "journal/reader.h"

#include "journal/schema.h"

namespace culprit::journal {
namespace {

// The last one is the hash of the row before.
constexpr std::string_view kColumns =
    "SELECT id, at, kind, body, hash, coalesce("
    "(SELECT before.hash FROM entry AS before WHERE before.id = entry.id - 1), "
    "(SELECT dropped.hash FROM anchor AS dropped WHERE dropped.id = entry.id - 1), "
    "zeroblob(32)) FROM entry ";

}  // namespace

Expected<bool> Cursor::next(Entry& entry) {
  const auto row = statement_.step();
  if (!row || !*row) return row;
  entry.id = statement_.integer(0);
  entry.at = statement_.integer(1);
  entry.kind = statement_.bytes(2);
  entry.body = statement_.bytes(3);
  return true;
}

bool Cursor::is_as_written(const Entry& entry, Hasher& hasher) const {
  const auto before = hash_from(statement_.bytes(5));
  const auto stored = hash_from(statement_.bytes(4));
  return before && stored && hasher.link(*before, entry) == *stored;
}

Expected<Reader> Reader::open(const std::filesystem::path& path) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot read the journal '" + path.string() + "': " + why};
  };
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return failure("there is no such file");
  if (std::filesystem::is_directory(path, error))
    return failure("it is a folder; name the .journal file in it");
  auto database = Database::open(path, Database::Mode::kRead);
  if (!database) return failure(database.error());
  if (const auto fits = check_schema(*database); !fits) return failure(fits.error());
  return Reader(std::move(*database));
}

Expected<Cursor> Reader::entries(Which which, std::int64_t from) const {
  std::string sql(kColumns);
  sql += which == Which::kAll ? "WHERE id >= ?1" : "WHERE id >= ?1 AND kind <> 'steps'";
  auto statement = database_.prepare(sql + " ORDER BY id");
  if (!statement) return Error{statement.error()};
  statement->bind(1, from);
  return Cursor(std::move(*statement));
}

Expected<std::optional<Entry>> Reader::entry(std::int64_t id) const {
  auto statement = database_.prepare(std::string(kColumns) + "WHERE id = ?1");
  if (!statement) return Error{statement.error()};
  statement->bind(1, id);
  Cursor cursor(std::move(*statement));
  Entry entry;
  const auto row = cursor.next(entry);
  if (!row) return Error{row.error()};
  return *row ? std::optional(entry) : std::nullopt;
}

Expected<std::optional<Entry>> Reader::newest(std::string_view kind, std::int64_t before) const {
  auto statement = database_.prepare(
      std::string(kColumns) +
      "WHERE kind <> 'steps' AND kind = ?1 AND (?2 = 0 OR id < ?2) ORDER BY id DESC LIMIT 1");
  if (!statement) return Error{statement.error()};
  statement->bind(1, kind).bind(2, before);
  Cursor cursor(std::move(*statement));
  Entry entry;
  const auto row = cursor.next(entry);
  if (!row) return Error{row.error()};
  return *row ? std::optional(entry) : std::nullopt;
}

Expected<std::int64_t> Reader::tail(std::int64_t count) const {
  return database_.number(
      "SELECT coalesce(min(id), 1) FROM (SELECT id FROM entry WHERE kind <> 'steps' ORDER BY id "
      "DESC LIMIT " +
      std::to_string(count) + ")");
}

}  // namespace culprit::journal
