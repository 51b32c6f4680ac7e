#include "journal/schema.h"

#include <array>
#include <string>

namespace culprit::journal {
namespace {

// "culp": shows file(1) and us whose file it is.
constexpr std::int64_t kApplication = 0x63756c70;

// Step n makes version n + 1 of version n. A released step never changes.
constexpr std::array kMigrations = {
    R"sql(
CREATE TABLE entry(
  id   INTEGER PRIMARY KEY,  -- 1, 2, 3 ...
  at   INTEGER NOT NULL,     -- nanoseconds since 1970, UTC
  kind TEXT    NOT NULL,
  body         NOT NULL,     -- JSON; of 'steps' bytes
  hash BLOB    NOT NULL      -- SHA-256, chained
);
CREATE INDEX readable ON entry(id) WHERE kind <> 'steps';
CREATE TABLE anchor(id INTEGER NOT NULL, hash BLOB NOT NULL);  -- of the last row that was dropped
CREATE TABLE belief(
  rule TEXT NOT NULL, strategy TEXT NOT NULL,
  alpha REAL NOT NULL, beta REAL NOT NULL, prior_alpha REAL NOT NULL, prior_beta REAL NOT NULL,
  PRIMARY KEY(rule, strategy)
) WITHOUT ROWID;
CREATE TABLE coupling(
  cause TEXT NOT NULL, effect TEXT NOT NULL, cleared REAL NOT NULL, stayed REAL NOT NULL,
  PRIMARY KEY(cause, effect)
) WITHOUT ROWID;
)sql",
    // It may be there if only the version is damaged.
    R"sql(
CREATE TABLE IF NOT EXISTS latency(
  rule TEXT PRIMARY KEY, count INTEGER NOT NULL,
  least REAL NOT NULL, most REAL NOT NULL  -- seconds
) WITHOUT ROWID;
)sql",
    // Made anew, which also works if the exposure is there and only the version is damaged.
    R"sql(
ALTER TABLE coupling RENAME TO coupling_before;
CREATE TABLE coupling(
  cause TEXT NOT NULL, effect TEXT NOT NULL, cleared REAL NOT NULL, stayed REAL NOT NULL,
  spared REAL NOT NULL,  -- exposure
  PRIMARY KEY(cause, effect)
) WITHOUT ROWID;
INSERT INTO coupling SELECT cause, effect, cleared, stayed, 0 FROM coupling_before;
DROP TABLE coupling_before;
)sql"};

// A reader takes what later versions added for empty.
constexpr std::int64_t kOldestRead = 1;

struct Found {
  std::int64_t version = 0;
  bool is_new = false;
};

Expected<Found> look(const Database& database) {
  const auto application = database.number("PRAGMA application_id");
  const auto version = database.number("PRAGMA user_version");
  const auto tables = database.number("SELECT count(*) FROM sqlite_schema");
  for (const auto* answer : {&application, &version, &tables}) {
    if (!*answer) return Error{answer->error()};
  }
  if (*tables == 0 && *application == 0) return Found{0, true};
  if (*application != kApplication) return Error{"it is a database of another program"};
  if (*version > schema_version())
    return Error{"it was written by a newer culprit (version " + std::to_string(*version) +
                 " of the file, this one knows " + std::to_string(schema_version()) + ")"};
  return Found{*version, false};
}

bool is_of_version(const Database& database, int least) {
  const auto version = database.number("PRAGMA user_version");
  return version && *version >= least;
}

}  // namespace

int schema_version() { return static_cast<int>(kMigrations.size()); }

Expected<void> prepare_schema(Database& database) {
  const auto found = look(database);
  if (!found) return Error{found.error()};
  if (found->version == schema_version()) return {};
  std::string sql = "BEGIN IMMEDIATE;";
  for (auto version = static_cast<std::size_t>(found->version); version < kMigrations.size();
       ++version)
    sql += kMigrations[version];
  sql += "PRAGMA application_id = " + std::to_string(kApplication) + ";";
  sql += "PRAGMA user_version = " + std::to_string(schema_version()) + "; COMMIT;";
  auto made = database.run(sql);
  if (!made) (void)database.run("ROLLBACK");
  return made;
}

Expected<void> check_schema(const Database& database) {
  const auto found = look(database);
  if (!found) return Error{found.error()};
  if (found->is_new) return Error{"it is empty"};
  if (found->version < kOldestRead)
    return Error{"it was written by an older culprit; culprit run brings it up to date"};
  return {};
}

bool has_latencies(const Database& database) { return is_of_version(database, 2); }
bool has_exposure(const Database& database) { return is_of_version(database, 3); }

bool has_damaged_head(const Database& database) {
  constexpr int kNoCulpritYet = 1000;
  const auto tables = database.number(
      "SELECT count(*) FROM sqlite_schema WHERE name IN ('entry', 'anchor', 'belief', 'coupling')");
  const auto application = database.number("PRAGMA application_id");
  const auto version = database.number("PRAGMA user_version");
  if (!tables || *tables < 4 || !application || !version) return false;
  return *application != kApplication || *version < 1 || *version > kNoCulpritYet;
}

}  // namespace culprit::journal
