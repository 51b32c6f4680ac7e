#include "fleet/outbox.h"

#include <array>
#include <fstream>
#include <functional>
#include <random>

#include "journal/entry.h"

namespace culprit::fleet {
namespace {

namespace fs = std::filesystem;
using journal::Database;

constexpr int kVersion = 1;
constexpr std::int64_t kApplication = 0x63756c66;  // "culf"

constexpr const char* kOutboxTables = R"sql(
BEGIN IMMEDIATE;
CREATE TABLE value(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE run(id TEXT PRIMARY KEY, row INTEGER NOT NULL, began INTEGER NOT NULL,
  culprit TEXT NOT NULL, model TEXT NOT NULL, rule_set TEXT NOT NULL, context TEXT NOT NULL);
CREATE TABLE outcome(run TEXT NOT NULL, rule TEXT NOT NULL, strategy TEXT NOT NULL,
  definition TEXT NOT NULL, helped INTEGER NOT NULL, failed INTEGER NOT NULL,
  is_sent INTEGER NOT NULL DEFAULT 0, PRIMARY KEY(run, rule, strategy));
CREATE INDEX unsent_outcome ON outcome(is_sent) WHERE is_sent = 0;
CREATE TABLE failure(run TEXT NOT NULL, row INTEGER NOT NULL, incident INTEGER NOT NULL,
  rule TEXT NOT NULL, criticality TEXT NOT NULL, component TEXT NOT NULL, began INTEGER NOT NULL,
  ended INTEGER NOT NULL, repair REAL NOT NULL, how TEXT NOT NULL, helped_by TEXT NOT NULL,
  strategies INTEGER NOT NULL, failed INTEGER NOT NULL, is_exhausted INTEGER NOT NULL,
  is_sent INTEGER NOT NULL DEFAULT 0, PRIMARY KEY(run, row));
CREATE INDEX unsent_failure ON failure(is_sent) WHERE is_sent = 0;
PRAGMA application_id = 1668639846;
PRAGMA user_version = 1;
COMMIT;
)sql";
static_assert(kApplication == 1668639846 && kVersion == 1);

Expected<Database> open_database(const fs::path& path) {
  auto database = Database::open(path, Database::Mode::kWrite);
  if (!database) return database;
  for (const char* setting : {"PRAGMA journal_mode = WAL", "PRAGMA synchronous = NORMAL"}) {
    if (const auto set = database->run(setting); !set) return Error{set.error()};
  }
  const auto version = database->number("PRAGMA user_version");
  const auto tables = database->number("SELECT count(*) FROM sqlite_schema");
  if (!version || !tables) return Error{version ? tables.error() : version.error()};
  if (*tables == 0) {
    if (const auto made = database->run(kOutboxTables); !made) return Error{made.error()};
    return database;
  }
  if (*version != kVersion) return Error{"it was written by another culprit"};
  return database;
}

std::string random_number() {
  std::random_device random;
  std::string digits;
  for (int i = 0; i < 32; ++i) digits += "0123456789abcdef"[random() % 16];
  return digits;
}

// The computer's id is confidential (machine-id(5)).
std::string fingerprint(const std::string& machine, const std::string& robot) {
  if (machine.empty()) return "";
  journal::Hasher hasher;
  return journal::to_hex(hasher.of(robot + "|" + machine)).substr(0, 16);
}

}  // namespace

fs::path outbox_beside(const fs::path& journal) { return journal.string() + "-fleet"; }

std::string machine_id() {
  std::string all;
  for (const char* path : {"/etc/machine-id", "/sys/class/dmi/id/product_uuid"}) {
    std::ifstream file(path);
    std::string id;
    if (file >> id && id != "uninitialized") all += id + "|";
  }
  return all;
}

Expected<Outbox> Outbox::open(const fs::path& path, const std::string& machine) {
  const auto failure = [&](const std::string& why) {
    return Error{"cannot write '" + path.string() + "': " + why};
  };
  std::string remark;
  constexpr std::array kLooks = {"SELECT count(*) FROM sqlite_schema", "SELECT * FROM value",
                                 "SELECT count(*) FROM outcome", "SELECT count(*) FROM failure"};
  if (std::filesystem::exists(path) && Database::is_damaged(path, kLooks)) {
    const auto aside = Database::set_aside(path);
    if (!aside) return failure("it is damaged, and cannot be moved: " + aside.error());
    remark = "the file of unsent outcomes for the fleet was damaged; it is kept as '" +
             aside->string() + "', and rebuilt from the journal";
  }
  auto database = open_database(path);
  if (!database) return failure(database.error());
  Outbox outbox(std::move(*database), std::move(remark));
  if (const auto identified = outbox.identify(machine); !identified)
    return failure(identified.error());
  return outbox;
}

Expected<void> Outbox::identify(const std::string& machine) {
  const auto robot = value("robot");
  if (!robot) return Error{robot.error()};
  if (!*robot) {
    identity_ = {random_number(), "", "", true, false};
    identity_.machine = fingerprint(machine, identity_.robot);
    return in_one([&]() -> Expected<void> {
      if (const auto set = set_value("robot", identity_.robot); !set) return set;
      return set_value("machine", identity_.machine);
    });
  }
  const auto before = value("before");
  const auto known = value("machine");
  if (!before || !known) return Error{before ? known.error() : before.error()};
  identity_ = {**robot, before->value_or(""), known->value_or(""), false, false};
  const std::string now = fingerprint(machine, identity_.robot);
  if (now.empty() || identity_.machine.empty() || now == identity_.machine) return {};
  const auto changed = become_another(machine);
  identity_.is_copy = true;
  return changed;
}

Expected<void> Outbox::become_another(const std::string& machine) {
  Identity next{random_number(), identity_.robot, "", false, false};
  next.machine = fingerprint(machine, next.robot);
  const auto done = in_one([&]() -> Expected<void> {
    if (const auto set = set_value("robot", next.robot); !set) return set;
    if (const auto set = set_value("before", next.before); !set) return set;
    return set_value("machine", next.machine);
  });
  if (done) identity_ = std::move(next);
  return done;
}

Expected<void> Outbox::in_one(const std::function<Expected<void>()>& write) {
  auto done = database_.run("BEGIN IMMEDIATE");
  if (!done) return done;
  done = write();
  if (done) done = database_.run("COMMIT");
  if (!done) database_.roll_back();
  return done;
}

Expected<Outbox::Place> Outbox::newest_run() const {
  const auto row =
      database_.number("SELECT coalesce((SELECT value FROM value WHERE name = 'run_row'), 0)");
  const auto run = value("run");
  if (!row || !run) return Error{row ? run.error() : row.error()};
  return Place{*row, run->value_or("")};
}

Expected<void> Outbox::keep(const Run& run, const std::map<StrategyName, Counts>& counts,
                            const std::map<StrategyName, std::string>& definitions,
                            const std::vector<Failure>& failures) {
  return in_one([&]() -> Expected<void> {
    if (const auto written = write(run, counts, definitions, failures); !written) return written;
    return bound();
  });
}

Expected<void> Outbox::write(const Run& run, const std::map<StrategyName, Counts>& counts,
                             const std::map<StrategyName, std::string>& definitions,
                             const std::vector<Failure>& failures) {
  if (const auto set = set_value("run_row", std::to_string(run.row)); !set) return set;
  if (const auto set = set_value("run", run.id); !set) return set;
  if (counts.empty() && failures.empty()) return {};
  auto insert = database_.prepare("INSERT OR IGNORE INTO run VALUES(?, ?, ?, ?, ?, ?, ?)");
  if (!insert) return Error{insert.error()};
  insert->bind(1, std::string_view(run.id)).bind(2, run.row).bind(3, run.began);
  insert->bind(4, std::string_view(run.culprit)).bind(5, std::string_view(run.model));
  insert->bind(6, std::string_view(run.rule_set)).bind(7, std::string_view(run.context));
  if (const auto done = insert->step(); !done) return Error{done.error()};

  auto outcome = database_.prepare(
      "INSERT INTO outcome VALUES(?, ?, ?, ?, ?, ?, 0) ON CONFLICT(run, rule, strategy) DO UPDATE "
      "SET helped = max(helped, excluded.helped), failed = max(failed, excluded.failed), is_sent = "
      "0 WHERE helped < excluded.helped OR failed < excluded.failed");
  if (!outcome) return Error{outcome.error()};
  for (const auto& [name, count] : counts) {
    const auto definition = definitions.find(name);
    outcome->bind(1, std::string_view(run.id)).bind(2, std::string_view(name.rule));
    outcome->bind(3, std::string_view(name.strategy));
    outcome->bind(4, definition == definitions.end() ? std::string_view("")
                                                     : std::string_view(definition->second));
    outcome->bind(5, count.helped).bind(6, count.failed);
    if (const auto done = outcome->step(); !done) return Error{done.error()};
  }

  auto failure = database_.prepare(
      "INSERT INTO failure VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 0) ON CONFLICT(run, "
      "row) DO UPDATE SET component = excluded.component, ended = excluded.ended, repair = "
      "excluded.repair, how = excluded.how, helped_by = excluded.helped_by, strategies = "
      "excluded.strategies, failed = excluded.failed, is_exhausted = excluded.is_exhausted, "
      "is_sent = 0 WHERE ended <> excluded.ended OR strategies <> excluded.strategies OR failed <> "
      "excluded.failed OR is_exhausted <> excluded.is_exhausted OR component <> "
      "excluded.component");
  if (!failure) return Error{failure.error()};
  for (const Failure& each : failures) {
    failure->bind(1, std::string_view(run.id)).bind(2, each.row).bind(3, each.incident);
    failure->bind(4, std::string_view(each.rule)).bind(5, std::string_view(each.criticality));
    failure->bind(6, std::string_view(each.component)).bind(7, each.began).bind(8, each.ended);
    failure->bind(9, each.repair_seconds).bind(10, std::string_view(each.how));
    failure->bind(11, std::string_view(each.helped_by)).bind(12, each.strategies);
    failure->bind(13, each.failed).bind(14, std::int64_t{each.is_exhausted});
    if (const auto done = failure->step(); !done) return Error{done.error()};
  }
  return {};
}

// A twentieth more goes than has to, so that this is seldom.
Expected<void> Outbox::bound() {
  const auto limit = [&](const std::string& table, std::int64_t most,
                         const std::string& order) -> Expected<void> {
    const auto count = database_.number("SELECT count(*) FROM " + table);
    if (!count) return Error{count.error()};
    if (*count <= most) return {};
    const std::string oldest = "SELECT rowid FROM " + table + " ORDER BY is_sent DESC, " + order +
                               " LIMIT " + std::to_string(*count - most + most / 20);
    const auto unsent = database_.number("SELECT count(*) FROM " + table +
                                         " WHERE is_sent = 0 AND rowid IN (" + oldest + ")");
    const auto before = dropped();
    if (!unsent || !before) return Error{unsent ? before.error() : unsent.error()};
    if (*unsent > 0) {
      if (const auto set = set_value("dropped", std::to_string(*before + *unsent)); !set)
        return set;
    }
    return database_.run("DELETE FROM " + table + " WHERE rowid IN (" + oldest + ")");
  };
  if (const auto done = limit("failure", kMostFailures, "rowid"); !done) return done;
  if (const auto done = limit("outcome", kMostCounts, "rowid"); !done) return done;
  return database_.run(
      "DELETE FROM run WHERE NOT EXISTS (SELECT 1 FROM outcome WHERE run = run.id) AND NOT EXISTS "
      "(SELECT 1 FROM failure WHERE run = run.id)");
}

Expected<Outbox::News> Outbox::news() const {
  const auto found = database_.number(
      "SELECT CASE WHEN EXISTS (SELECT 1 FROM failure WHERE is_sent = 0 AND is_exhausted AND ended "
      "= 0) THEN 2 "
      "WHEN EXISTS (SELECT 1 FROM failure WHERE is_sent = 0) OR EXISTS (SELECT 1 FROM outcome "
      "WHERE is_sent = 0) THEN 1 "
      "ELSE 0 END");
  if (!found) return Error{found.error()};
  return static_cast<News>(*found);
}

Expected<Waiting> Outbox::waiting(int most) const {
  Waiting waiting;
  const std::string limit = " ORDER BY rowid LIMIT " + std::to_string(most);
  auto outcomes = database_.prepare(
      "SELECT run, rule, strategy, definition, helped, failed FROM outcome WHERE is_sent = 0" +
      limit);
  if (!outcomes) return Error{outcomes.error()};
  const auto text = [](const journal::Statement& row, int column) {
    return std::string(row.bytes(column));
  };
  auto row = outcomes->step();
  for (; row && *row; row = outcomes->step())
    waiting.outcomes.push_back({text(*outcomes, 0),
                                {text(*outcomes, 1), text(*outcomes, 2)},
                                text(*outcomes, 3),
                                {outcomes->integer(4), outcomes->integer(5)}});
  if (!row) return Error{row.error()};
  auto failures = database_.prepare(
      "SELECT run, row, incident, rule, criticality, component, began, ended, repair, how, "
      "helped_by, strategies, failed, is_exhausted FROM failure WHERE is_sent = 0" +
      limit);
  if (!failures) return Error{failures.error()};
  row = failures->step();
  for (; row && *row; row = failures->step()) {
    const journal::Statement& f = *failures;
    waiting.failures.push_back({text(f, 0),
                                {f.integer(1), f.integer(2), text(f, 3), text(f, 4), text(f, 5),
                                 f.integer(6), f.integer(7), f.real(8), text(f, 9), text(f, 10),
                                 f.integer(11), f.integer(12), f.integer(13) != 0}});
  }
  if (!row) return Error{row.error()};
  std::map<std::string, bool> named;
  for (const Outcome& each : waiting.outcomes) named[each.run] = true;
  for (const RunFailure& each : waiting.failures) named[each.run] = true;
  auto runs = database_.prepare(
      "SELECT id, row, began, culprit, model, rule_set, context FROM run WHERE id = ?");
  if (!runs) return Error{runs.error()};
  for (const auto& [run, is_named] : named) {
    runs->bind(1, std::string_view(run));
    for (row = runs->step(); row && *row; row = runs->step())
      waiting.runs.push_back({text(*runs, 0), runs->integer(1), runs->integer(2), text(*runs, 3),
                              text(*runs, 4), text(*runs, 5), text(*runs, 6)});
    if (!row) return Error{row.error()};
  }
  return waiting;
}

Expected<void> Outbox::sent(const Waiting& what) {
  return in_one([&]() -> Expected<void> {
    auto outcome = database_.prepare(
        "UPDATE outcome SET is_sent = 1 WHERE run = ? AND rule = ? AND strategy = ? AND helped = ? "
        "AND failed = ?");
    if (!outcome) return Error{outcome.error()};
    for (const Outcome& each : what.outcomes) {
      outcome->bind(1, std::string_view(each.run)).bind(2, std::string_view(each.name.rule));
      outcome->bind(3, std::string_view(each.name.strategy));
      outcome->bind(4, each.counts.helped).bind(5, each.counts.failed);
      if (const auto done = outcome->step(); !done) return Error{done.error()};
    }
    auto failure = database_.prepare(
        "UPDATE failure SET is_sent = 1 WHERE run = ? AND row = ? AND ended = ? AND strategies = ? "
        "AND failed = ? AND is_exhausted = ? AND component = ?");
    if (!failure) return Error{failure.error()};
    for (const auto& [run, each] : what.failures) {
      failure->bind(1, std::string_view(run)).bind(2, each.row).bind(3, each.ended);
      failure->bind(4, each.strategies).bind(5, each.failed);
      failure->bind(6, std::int64_t{each.is_exhausted}).bind(7, std::string_view(each.component));
      if (const auto done = failure->step(); !done) return Error{done.error()};
    }
    return {};
  });
}

Expected<std::int64_t> Outbox::dropped() const {
  return database_.number("SELECT coalesce((SELECT value FROM value WHERE name = 'dropped'), 0)");
}

Expected<std::optional<std::string>> Outbox::value(const std::string& name) const {
  auto statement = database_.prepare("SELECT value FROM value WHERE name = ?");
  if (!statement) return Error{statement.error()};
  const auto row = statement->bind(1, std::string_view(name)).step();
  if (!row) return Error{row.error()};
  if (!*row) return std::optional<std::string>();
  return std::optional(std::string(statement->bytes(0)));
}

Expected<void> Outbox::set_value(const std::string& name, const std::string& value) {
  auto statement = database_.prepare("INSERT OR REPLACE INTO value VALUES(?, ?)");
  if (!statement) return Error{statement.error()};
  statement->bind(1, std::string_view(name)).bind(2, std::string_view(value));
  const auto done = statement->step();
  if (!done) return Error{done.error()};
  return {};
}

}  // namespace culprit::fleet
