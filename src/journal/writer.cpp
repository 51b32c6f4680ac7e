#include "journal/writer.h"

#include <sys/stat.h>
#include <system_error>

#include "journal/json.h"
#include "journal/schema.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;

Error failure(const fs::path& path, const std::string& why) {
  return {"cannot write the journal '" + path.string() + "': " + why};
}

std::uint64_t inode_of(const fs::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

// Moves a file and what SQLite keeps beside it to the first free name.
Expected<fs::path> set_aside(const fs::path& path) {
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

Expected<Database> open_database(const fs::path& path) {
  auto database = Database::open(path, Database::Mode::kWrite);
  if (!database) return database;
  for (const char* setting : {"PRAGMA journal_mode = WAL", "PRAGMA synchronous = NORMAL"}) {
    if (const auto set = database->run(setting); !set) return Error{set.error()};
  }
  if (const auto ready = prepare_schema(*database); !ready) return Error{ready.error()};
  return database;
}

// Whether there is a journal of ours that cannot be read any more. A file of another program is
// none of our business.
bool is_damaged(const fs::path& path) {
  if (Database::is_damaged(path, "SELECT count(*) FROM sqlite_schema")) return true;
  const auto database = Database::open(path, Database::Mode::kRead);
  return database && check_schema(*database) &&
         Database::is_damaged(path, "SELECT id, hash FROM entry ORDER BY id DESC LIMIT 1");
}

Json body_of(const LearnedBelief& learned) {
  return {{"rule", learned.rule},
          {"strategy", learned.strategy},
          {"alpha", learned.belief.alpha},
          {"beta", learned.belief.beta},
          {"prior", {learned.prior.alpha, learned.prior.beta}}};
}

Json body_of(const LearnedCoupling& learned) {
  return {{"cause", learned.cause},
          {"effect", learned.effect},
          {"cleared", learned.coupling.cleared},
          {"stayed", learned.coupling.stayed}};
}

}  // namespace

Writer::Writer(fs::path path, Options options, FileLock lock, Database database)
    : path_(std::move(path)),
      options_(options),
      lock_(std::move(lock)),
      database_(std::move(database)),
      inode_(inode_of(path_)) {}

Expected<Writer> Writer::open(const fs::path& path, Options options) {
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) return failure(path, error.message());
  auto lock = FileLock::take(path.string() + "-lock");
  if (!lock) return failure(path, lock.error());
  if (!*lock) return failure(path, "another culprit writes it; choose another with --journal");

  std::string remark;
  Learned saved;
  // A text that somebody named by mistake is no database either: only what is called a journal is
  // moved.
  if (path.extension() == ".journal" && fs::exists(path) && is_damaged(path)) {
    if (const auto old = Database::open(path, Database::Mode::kRead)) {
      if (const auto learned = read_learned(*old)) saved = *learned;
    }
    const auto aside = set_aside(path);
    if (!aside) return failure(path, "it is damaged, and cannot be moved: " + aside.error());
    remark = "the journal was damaged; it is kept as '" + aside->string() +
             "' and a new one begun" + (saved.beliefs.empty() ? "" : ", with what was learned");
  }
  auto database = open_database(path);
  if (!database) return failure(path, database.error());
  Writer writer(path, options, std::move(**lock), std::move(*database));
  writer.remark_ = std::move(remark);
  if (const auto begun = writer.begin(); !begun) return failure(path, begun.error());
  if (!saved.beliefs.empty() || !saved.couplings.empty()) {
    const auto kept = writer.append({{}, saved}, 0, Durability::kPowerFailure);
    if (!kept) return Error{kept.error()};
  }
  return writer;
}

Expected<void> Writer::begin() {
  const auto newest = newest_link(database_);
  if (!newest) return Error{newest.error()};
  newest_ = *newest;
  auto statement =
      database_.prepare("INSERT INTO entry(id, at, kind, body, hash) VALUES(?, ?, ?, ?, ?)");
  if (!statement) return Error{statement.error()};
  insert_ = std::move(*statement);
  return {};
}

Expected<void> Writer::append(const Batch& batch, std::int64_t now, Durability durability) {
  if (const auto there = check_name(); !there) return there;
  const bool is_durable = durability == Durability::kPowerFailure;
  if (is_durable) (void)database_.run("PRAGMA synchronous = FULL");
  const Link before = newest_;
  auto written = database_.run("BEGIN IMMEDIATE");
  if (written) {
    written = write(batch, now);
    if (written) written = database_.run("COMMIT");
    if (!written) (void)database_.run("ROLLBACK");
  }
  if (is_durable) (void)database_.run("PRAGMA synchronous = NORMAL");
  if (written) return {};
  newest_ = before;
  return failure(path_, written.error());
}

Expected<void> Writer::write(const Batch& batch, std::int64_t now) {
  for (const Entry& entry : batch.entries) {
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  if (const auto kept = keep(batch.learned, now); !kept) return kept;
  return drop_old(now);
}

Expected<void> Writer::insert(Entry entry) {
  entry.id = newest_.id + 1;
  const Hash hash = hasher_.link(newest_.hash, entry);
  insert_->bind(1, entry.id).bind(2, entry.at).bind(3, std::string_view(entry.kind));
  if (entry.kind == kind::kSteps) {
    insert_->bind_blob(4, entry.body);
  } else {
    insert_->bind(4, std::string_view(entry.body));
  }
  insert_->bind_blob(5, {reinterpret_cast<const char*>(hash.data()), hash.size()});
  if (const auto inserted = insert_->step(); !inserted) return Error{inserted.error()};
  newest_ = {entry.id, hash};
  return {};
}

Expected<void> Writer::keep(const Learned& learned, std::int64_t now) {
  auto belief = database_.prepare("INSERT OR REPLACE INTO belief VALUES(?, ?, ?, ?, ?, ?)");
  auto coupling = database_.prepare("INSERT OR REPLACE INTO coupling VALUES(?, ?, ?, ?)");
  if (!belief) return Error{belief.error()};
  if (!coupling) return Error{coupling.error()};
  for (const LearnedBelief& each : learned.beliefs) {
    belief->bind(1, std::string_view(each.rule)).bind(2, std::string_view(each.strategy));
    belief->bind(3, each.belief.alpha).bind(4, each.belief.beta);
    belief->bind(5, each.prior.alpha).bind(6, each.prior.beta);
    if (const auto done = belief->step(); !done) return Error{done.error()};
    const Entry entry{0, now, std::string(kind::kBelief), to_text(body_of(each))};
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  for (const LearnedCoupling& each : learned.couplings) {
    coupling->bind(1, std::string_view(each.cause)).bind(2, std::string_view(each.effect));
    coupling->bind(3, each.coupling.cleared).bind(4, each.coupling.stayed);
    if (const auto done = coupling->step(); !done) return Error{done.error()};
    const Entry entry{0, now, std::string(kind::kCoupling), to_text(body_of(each))};
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  return {};
}

Expected<int> Writer::forget(const std::string& rule, std::int64_t now) {
  const auto all = learned();
  if (!all) return Error{all.error()};
  int count = 0;
  for (const auto& each : all->beliefs) count += rule.empty() || each.rule == rule ? 1 : 0;
  const std::string what = rule.empty() ? "all rules" : rule;
  Batch batch;
  batch.entries.push_back(
      {0, now, std::string(kind::kBelief),
       to_text({{"forgotten", rule}, {"text", "forgot what was learned of " + what}})});
  auto begun = database_.run("BEGIN IMMEDIATE");
  if (!begun) return failure(path_, begun.error());
  const Link before = newest_;
  auto done = write(batch, now);
  for (const char* sql : {"DELETE FROM belief WHERE ?1 = '' OR rule = ?1",
                          "DELETE FROM coupling WHERE ?1 = '' OR cause = ?1 OR effect = ?1"}) {
    auto statement = database_.prepare(sql);
    if (!statement) return failure(path_, statement.error());
    const auto deleted = statement->bind(1, std::string_view(rule)).step();
    if (done && !deleted) done = Error{deleted.error()};
  }
  if (done) done = database_.run("COMMIT");
  if (done) return count;
  (void)database_.run("ROLLBACK");
  newest_ = before;
  return failure(path_, done.error());
}

// A few of the oldest rows with each batch, so that no batch takes long.
Expected<void> Writer::drop_old(std::int64_t now) {
  constexpr std::int64_t kAtOnce = 200;
  const auto oldest = database_.number("SELECT min(id) FROM entry");
  if (!oldest) return Error{oldest.error()};
  const auto pages = database_.number(
      "SELECT (page_count - freelist_count) * page_size FROM pragma_page_count, "
      "pragma_freelist_count, pragma_page_size");
  if (!pages) return Error{pages.error()};
  const std::int64_t last = std::min(*oldest + kAtOnce - 1, newest_.id - 1);
  std::int64_t end = last;
  if (*pages <= options_.max_bytes) {
    const auto old =
        database_.number("SELECT max(id) FROM entry WHERE id <= " + std::to_string(last) +
                         " AND at < " + std::to_string(now - options_.max_age_ns));
    if (!old) return Error{old.error()};
    end = *old;
  }
  if (end < *oldest) return {};
  const std::string id = std::to_string(end);
  return database_.run(
      "DELETE FROM anchor; INSERT INTO anchor SELECT id, hash FROM entry WHERE id = " + id +
      "; DELETE FROM entry WHERE id <= " + id);
}

// Rows written to a file that somebody removed or replaced would be lost in silence.
Expected<void> Writer::check_name() const {
  if (inode_of(path_) == inode_) return {};
  return failure(path_, "it was removed or replaced");
}

}  // namespace culprit::journal
