#include "fleet/schema.h"

#include "fleet/migrations.h"

namespace culprit::fleet {
namespace {

// One set-up at a time, of whatever version.
constexpr const char* kLock = "SELECT pg_advisory_xact_lock(hashtext('culprit fleet init'))";

Expected<int> version_of(Postgres& server) {
  const auto there = server.query("SELECT to_regclass('culprit.schema_version') IS NOT NULL");
  if (!there) return Error{there.error()};
  if (there->empty() || text_in((*there)[0][0]) != "t") return 0;
  const auto version = server.query("SELECT max(version) FROM culprit.schema_version");
  if (!version) return Error{version.error()};
  return version->empty() ? 0 : static_cast<int>(integer_in((*version)[0][0]));
}

Expected<void> make_roles(Postgres& server, Done& done) {
  for (const std::string role : {"culprit_robot", "culprit_reader"}) {
    const auto there = server.query("SELECT 1 FROM pg_roles WHERE rolname = $1", {role});
    if (!there) return Error{there.error()};
    if (!there->empty()) continue;
    if (const auto made = server.run("CREATE ROLE " + role + " NOLOGIN"); !made) {
      return Error{made.error() +
                   "; let an administrator run once: CREATE ROLE culprit_robot "
                   "NOLOGIN; CREATE ROLE culprit_reader NOLOGIN;"};
    }
    done.push_back("made the role " + role);
  }
  return {};
}

Expected<void> migrate(Postgres& server, int from, Done& done) {
  for (int version = from; version < schema_version(); ++version) {
    const auto made = server.run(migration(version));
    if (!made) return Error{"version " + std::to_string(version + 1) + ": " + made.error()};
    const auto noted = server.query("INSERT INTO culprit.schema_version(version) VALUES($1)",
                                    {std::to_string(version + 1)});
    if (!noted) return Error{noted.error()};
    done.push_back(version == 0 ? "made the schema culprit"
                                : "brought the schema to version " + std::to_string(version + 1));
  }
  return {};
}

Expected<void> maintain(Postgres& server, const Setup& setup, Done& done) {
  const auto kept = server.query(
      "INSERT INTO culprit.setting VALUES('keep_days', $1) ON CONFLICT (name) DO UPDATE SET value "
      "= "
      "EXCLUDED.value",
      {std::to_string(setup.keep_days)});
  if (!kept) return Error{kept.error()};
  const auto said = server.query("SELECT culprit.maintain()");
  if (!said) return Error{said.error()};
  for (const Row& row : *said) done.push_back(text_in(row[0]));
  return {};
}

Expected<Done> set_up_in_transaction(Postgres& server, const Setup& setup) {
  Done done;
  if (const auto locked = server.query(kLock); !locked) return Error{locked.error()};
  const auto version = version_of(server);
  if (!version) return Error{version.error()};
  if (*version > schema_version())
    return Error{"the database is of a newer culprit (version " + std::to_string(*version) +
                 " of its schema, this one knows " + std::to_string(schema_version()) +
                 "); use that one"};
  if (const auto made = make_roles(server, done); !made) return Error{made.error()};
  if (const auto made = migrate(server, *version, done); !made) return Error{made.error()};
  if (const auto kept = maintain(server, setup, done); !kept) return Error{kept.error()};
  return done;
}

}  // namespace

int schema_version() { return migration_count(); }

Expected<Done> set_up(Postgres& server, const Setup& setup) {
  if (const auto begun = server.run("BEGIN"); !begun) return Error{begun.error()};
  auto done = set_up_in_transaction(server, setup);
  if (!done) {
    (void)server.run("ROLLBACK");
    return done;
  }
  if (const auto committed = server.run("COMMIT"); !committed) return Error{committed.error()};
  return done;
}

Expected<void> check_schema(Postgres& server) {
  const auto version = version_of(server);
  if (!version) return Error{version.error()};
  if (*version == 0)
    return Error{"it is not set up for a fleet: run culprit fleet init once, as its owner"};
  if (*version == schema_version()) return {};
  const std::string numbers = "version " + std::to_string(*version) + " of its schema, this one " +
                              "needs " + std::to_string(schema_version());
  if (*version > schema_version())
    return Error{"it is of a newer culprit (" + numbers + "): update this one"};
  return Error{"it is of an older culprit (" + numbers + "): run culprit fleet init, as its owner"};
}

}  // namespace culprit::fleet
