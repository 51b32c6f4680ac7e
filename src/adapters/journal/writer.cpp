#include "journal/writer.h"

#include <array>
#include <chrono>
#include <fstream>
#include <sys/stat.h>
#include <system_error>

#include "base/invariant.h"
#include "journal/schema.h"
#include "json/json.h"

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

Expected<Database> open_database(const fs::path& path) {
  auto database = Database::open(path, Database::Mode::kWrite);
  if (!database) return database;
  for (const char* setting : {"PRAGMA journal_mode = WAL", "PRAGMA synchronous = NORMAL",
                              "PRAGMA wal_autocheckpoint = 0"}) {
    if (const auto set = database->run(setting); !set) return Error{set.error()};
  }
  if (const auto ready = prepare_schema(*database); !ready) return Error{ready.error()};
  return database;
}

// A file that would be written by a later SQLite counts as one that may not be written.
bool has_damaged_beginning(const fs::path& path) {
  std::array<char, 20> head{};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(head.data(), head.size())) return false;
  const auto is_known = [](char version) { return version == 1 || version == 2; };
  return !is_known(head[18]) || !is_known(head[19]);
}

// Whether there is a journal of ours that cannot be read any more. A file of another program is
// none of our business.
bool is_damaged(const fs::path& path) {
  constexpr std::array kTables = {"SELECT count(*) FROM sqlite_schema"};
  if (Database::is_damaged(path, kTables)) return true;
  if (has_damaged_beginning(path)) return true;
  const auto database = Database::open(path, Database::Mode::kRead);
  if (!database) return false;
  if (has_damaged_head(*database)) return true;
  if (!check_schema(*database)) return false;
  constexpr std::array kLooks = {
      "SELECT id, hash FROM entry ORDER BY id DESC LIMIT 1",
      "SELECT body FROM entry WHERE kind <> 'steps' AND kind = 'session' ORDER BY id DESC LIMIT 1",
      "SELECT * FROM anchor", "SELECT * FROM belief", "SELECT * FROM coupling"};
  const auto hash =
      database->number("SELECT length(hash) FROM entry WHERE id = (SELECT max(id) FROM entry)");
  const bool has_hash = !hash || *hash == 0 || *hash == sizeof(Hash);
  if (!has_hash || Database::is_damaged(path, kLooks)) return true;
  constexpr std::array kNewerLooks = {"SELECT * FROM latency"};
  if (has_latencies(*database) && Database::is_damaged(path, kNewerLooks)) return true;
  constexpr std::array kNewestLooks = {"SELECT * FROM coincidence"};
  return has_coincidences(*database) && Database::is_damaged(path, kNewestLooks);
}

// The beliefs in a damaged file; nothing: they are lost.
std::optional<Learned> saved_from(const fs::path& path,
                                  const Expected<std::optional<LearnedCopy>>& copy) {
  const auto old = Database::open(path, Database::Mode::kRead);
  if (copy && *copy) {
    if (!old) return (*copy)->learned;
    const auto newest = brought_up_to_date(**copy, *old);
    return newest ? *newest : (*copy)->learned;
  }
  if (!old) return std::nullopt;
  const auto learned = read_learned(*old);
  return learned ? std::optional(*learned) : std::nullopt;
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

  const auto copy = read_copy(learned_beside(path));
  std::string remark;
  fs::path aside;
  std::optional<Learned> saved;
  // A text that somebody named by mistake is no database either: only what is called a journal is
  // moved.
  const bool looks_damaged = path.extension() == ".journal" && journal::is_damaged(path);
  if (fs::exists(path) && (options.is_damaged || looks_damaged)) {
    saved = saved_from(path, copy);
    const auto moved = Database::set_aside(path);
    if (!moved) return failure(path, "it is damaged, and cannot be moved: " + moved.error());
    aside = *moved;
    remark = "the journal was damaged; it is kept as '" + aside.string() +
             "' and a new one begun, " +
             (saved ? "with the learned values" : "without the learned values, which are lost");
  }
  options.is_damaged = false;
  auto database = open_database(path);
  if (!database) return failure(path, database.error());
  Writer writer(path, options, std::move(**lock), std::move(*database));
  writer.remark_ = std::move(remark);
  writer.aside_ = std::move(aside);
  auto begun = writer.begin();
  const bool is_first_try = writer.aside_.empty();
  if (begun && !is_first_try) begun = writer.restore(saved.value_or(Learned()));
  if (begun && is_first_try) begun = writer.compare(copy);
  if (begun) return writer;
  if (!is_first_try || !writer.database_.blames_file()) return failure(path, begun.error());
  options.is_damaged = true;
  { const Writer useless = std::move(writer); }  // lets go of the file and its lock
  return open(path, options);
}

Expected<void> Writer::begin() {
  const auto newest = newest_link(database_);
  if (!newest) return Error{newest.error()};
  newest_ = *newest;
  const auto session = database_.number(
      "SELECT coalesce(max(id), 0) FROM entry WHERE kind <> 'steps' AND kind = 'session'");
  if (!session) return Error{session.error()};
  session_ = *session;
  auto statement =
      database_.prepare("INSERT INTO entry(id, at, kind, body, hash) VALUES(?, ?, ?, ?, ?)");
  if (!statement) return Error{statement.error()};
  insert_ = std::move(*statement);
  return {};
}

// The tables have no checksum: that a bit of them changed shows beside the copy only.
Expected<void> Writer::compare(const Expected<std::optional<LearnedCopy>>& copy) {
  if (!copy) {
    remark_ = "culprit rewrites the second copy of its learned values: " + copy.error();
    return {};
  }
  if (!*copy) return {};
  const LearnedCopy& second = **copy;
  if (second.newest.id > newest_.id) {
    remark_ = newest_.id == 0
                  ? "the journal file is missing; culprit began a new one with the learned values"
                  : "the end of the journal is lost, all after row " + std::to_string(newest_.id) +
                        " (row " + std::to_string(second.newest.id) +
                        " was there): was its -wal file removed? culprit now uses the second copy "
                        "of its learned values";
    return restore(second.learned);
  }
  auto hash = database_.prepare("SELECT hash FROM entry WHERE id = ?1");
  if (!hash) return Error{hash.error()};
  const auto row = hash->bind(1, second.newest.id).step();
  if (!row) return Error{row.error()};
  // The copy is of another journal, which was replaced by this one.
  if (*row && hash_from(hash->bytes(0)) != second.newest.hash) return {};
  auto expected = brought_up_to_date(second, database_);
  const auto stored = learned();
  if (!expected || !stored) return Error{expected ? stored.error() : expected.error()};
  expected->coincidences = stored->coincidences;
  if (is_same(*expected, *stored)) return {};
  remark_ = "learned values were damaged in the journal; culprit uses their second copy";
  return restore(*expected);
}

// Makes it what is believed, and leaves a row about why.
Expected<void> Writer::restore(const Learned& learned) {
  const Link before = newest_;
  auto done = database_.run(
      "BEGIN IMMEDIATE; DELETE FROM belief; DELETE FROM coupling; DELETE FROM latency; "
      "DELETE FROM coincidence");
  const std::int64_t now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                               std::chrono::system_clock::now().time_since_epoch())
                               .count();
  if (done) done = insert({0, now, std::string(kind::kGap), to_line({{"text", remark_}})});
  if (done) done = keep(learned, now);
  if (done) done = database_.run("COMMIT");
  if (!done) {
    database_.roll_back();
    newest_ = before;
    return done;
  }
  copy_learned();
  return {};
}

void Writer::copy_learned() {
  const auto all = learned();
  const auto written =
      all ? write_copy(learned_beside(path_), {newest_, *all}) : Error{all.error()};
  is_copy_due_ = !written;
  copy_trouble_ = written ? "" : written.error();
}

// culprit does this itself: once the first row exists in the -wal file alone, the copy must be
// written. The copy names that row, and so shows when the -wal file is lost.
void Writer::move_wal() {
  const fs::path wal = path_.string() + "-wal";
  std::error_code error;
  const auto size = fs::file_size(wal, error);
  if (error || size < static_cast<std::uintmax_t>(options_.max_wal_bytes)) return;
  // Not now if somebody reads; then with a later batch.
  (void)database_.run("PRAGMA wal_checkpoint(TRUNCATE)");
  is_copy_due_ = fs::file_size(wal, error) == 0;
}

Expected<void> Writer::append(const Batch& batch, std::int64_t now, Durability durability) {
  is_damaged_ = false;
  if (const auto there = check_name(); !there) return there;
  const bool is_durable = durability == Durability::kPowerFailure;
  if (is_durable) (void)database_.run("PRAGMA synchronous = FULL");
  const Link before = newest_;
  const std::int64_t session_before = session_;
  auto written = database_.run("BEGIN IMMEDIATE");
  if (written) {
    written = write(batch, now);
    if (written) written = database_.run("COMMIT");
  }
  if (!written) {
    is_damaged_ = database_.blames_file();
    database_.roll_back();
  }
  if (is_durable) (void)database_.run("PRAGMA synchronous = NORMAL");
  if (!written) {
    newest_ = before;
    session_ = session_before;
    return failure(path_, written.error());
  }
  if (is_copy_due_ || batch.learned.has_outcomes()) copy_learned();
  // Somebody may wait for what has to be durable.
  if (!is_durable) move_wal();
  return {};
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
  if (entry.kind == kind::kSession) session_ = entry.id;
  return {};
}

Expected<void> Writer::keep(const Learned& learned, std::int64_t now) {
  auto belief = database_.prepare("INSERT OR REPLACE INTO belief VALUES(?, ?, ?, ?, ?, ?)");
  auto coupling = database_.prepare("INSERT OR REPLACE INTO coupling VALUES(?, ?, ?, ?, ?)");
  if (!belief) return Error{belief.error()};
  auto latency = database_.prepare("INSERT OR REPLACE INTO latency VALUES(?, ?, ?, ?)");
  if (!coupling) return Error{coupling.error()};
  if (!latency) return Error{latency.error()};
  for (const LearnedBelief& each : learned.beliefs) {
    belief->bind(1, std::string_view(each.rule)).bind(2, std::string_view(each.strategy));
    belief->bind(3, each.belief.alpha).bind(4, each.belief.beta);
    belief->bind(5, each.prior.alpha).bind(6, each.prior.beta);
    if (const auto done = belief->step(); !done) return Error{done.error()};
    const Entry entry{0, now, std::string(kind::kBelief), to_line(body_of(each))};
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  for (const LearnedCoupling& each : learned.couplings) {
    coupling->bind(1, std::string_view(each.cause)).bind(2, std::string_view(each.effect));
    coupling->bind(3, each.coupling.cleared).bind(4, each.coupling.stayed);
    coupling->bind(5, each.coupling.spared);
    if (const auto done = coupling->step(); !done) return Error{done.error()};
    const Entry entry{0, now, std::string(kind::kCoupling), to_line(body_of(each))};
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  for (const LearnedLatency& each : learned.latencies) {
    latency->bind(1, std::string_view(each.rule)).bind(2, std::int64_t{each.count});
    latency->bind(3, each.least_s).bind(4, each.most_s);
    if (const auto done = latency->step(); !done) return Error{done.error()};
    const Entry entry{0, now, std::string(kind::kLatency), to_line(body_of(each))};
    if (const auto inserted = insert(entry); !inserted) return inserted;
  }
  return keep(learned.coincidences);
}

Expected<void> Writer::keep(const std::vector<LearnedCoincidence>& coincidences) {
  if (coincidences.empty()) return {};
  auto row = database_.prepare("INSERT OR REPLACE INTO coincidence VALUES(?, ?, ?)");
  if (!row) return Error{row.error()};
  for (const LearnedCoincidence& each : coincidences) {
    row->bind(1, std::string_view(each.rule)).bind(2, std::string_view(each.other));
    row->bind(3, std::int64_t{each.count});
    if (const auto done = row->step(); !done) return Error{done.error()};
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
       to_line({{"forgotten", rule}, {"text", "forgot the learned values of " + what}})});
  auto begun = database_.run("BEGIN IMMEDIATE");
  if (!begun) return failure(path_, begun.error());
  const Link before = newest_;
  auto done = write(batch, now);
  for (const char* sql :
       {"DELETE FROM belief WHERE ?1 = '' OR rule = ?1",
        "DELETE FROM coupling WHERE ?1 = '' OR cause = ?1 OR effect = ?1",
        "DELETE FROM latency WHERE ?1 = '' OR rule = ?1 OR instr(rule, ?1 || ' ') = 1",
        "DELETE FROM coincidence WHERE ?1 = '' OR rule = ?1 OR other = ?1"}) {
    if (!done) break;
    auto statement = database_.prepare(sql);
    if (!statement) {
      done = Error{statement.error()};
      break;
    }
    const auto deleted = statement->bind(1, std::string_view(rule)).step();
    if (!deleted) done = Error{deleted.error()};
  }
  if (done) done = database_.run("COMMIT");
  if (done) {
    copy_learned();
    return count;
  }
  database_.roll_back();
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
    // Up to the first that is not old: a row may bear a time from before the clock was set.
    const auto young =
        database_.number("SELECT min(id) FROM entry WHERE id <= " + std::to_string(last) +
                         " AND at >= " + std::to_string(now - options_.max_age_ns));
    if (!young) return Error{young.error()};
    if (*young > 0) end = *young - 1;
  }
  wants_new_session_ = end >= *oldest && session_ == *oldest;
  if (session_ > 0) end = std::min(end, session_ - 1);
  if (end < *oldest) return {};
  CULPRIT_ASSERT(end < newest_.id);                 // the chain goes on from the newest row
  CULPRIT_ASSERT(session_ == 0 || end < session_);  // no row can be read without its session's
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
