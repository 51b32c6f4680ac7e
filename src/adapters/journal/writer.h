// The only writer of a journal file; a second one, in any process, is refused.
//
// A batch is in the file as a whole or not at all. Once append() has returned, the batch survives
// the end of the process, however it ends; with Durability::kPowerFailure it survives that of the
// machine.
//
// A damaged file is never written to and never deleted: it is renamed. The beliefs have a second
// copy (learned_copy.h), and are carried over.
//
// The oldest rows go, but never those from the newest `session` row on: the next run needs them.
#pragma once

#include <vector>

#include "journal/database.h"
#include "journal/entry.h"
#include "journal/file_lock.h"
#include "journal/learned.h"
#include "journal/learned_copy.h"
#include "journal/tables.h"

namespace culprit::journal {

enum class Durability : std::uint8_t { kProcessEnd, kPowerFailure };

struct Batch {
  std::vector<Entry> entries{};  // without `id`
  Learned learned{};             // what changed; each change makes a row, too, but of coincidences
};

class Writer {
 public:
  struct Options {
    std::int64_t max_bytes = std::int64_t{256} << 20;    // the oldest rows go beyond that
    std::int64_t max_age_ns = 30 * 86'400'000'000'000;   // and those that are older
    std::int64_t max_wal_bytes = std::int64_t{4} << 20;  // then what is in the -wal file moves
    // It is known to be damaged, however it looks: a row could not be read or written.
    bool is_damaged = false;
  };

  // Errors say why, with the path and what to do.
  static Expected<Writer> open(const std::filesystem::path& path, Options options);

  // The anomaly of the file and what was done about it; empty: none.
  const std::string& remark() const { return remark_; }
  const std::filesystem::path& path() const { return path_; }
  // Where the file that was damaged is now; empty if it was not.
  const std::filesystem::path& aside() const { return aside_; }

  // Whether the error that append() gave comes from damage: then the writer is of no use any more,
  // and the file must be opened again with Options::is_damaged.
  bool is_damaged() const { return is_damaged_; }
  // Why the second copy of what was learned is not written; empty: it is. It is tried again with
  // the next batch.
  const std::string& copy_trouble() const { return copy_trouble_; }
  // Whether rows should go that the next run needs. They go once there is a newer `session` row
  // with all that is to be known of them.
  bool wants_new_session() const { return wants_new_session_; }

  // `now`: nanoseconds since 1970. After an error nothing of the batch is in the file.
  Expected<void> append(const Batch& batch, std::int64_t now, Durability durability);

  // Forgets all that was learned: of one rule, or of all if `rule` is empty. Gives how many beliefs
  // that were.
  Expected<int> forget(const std::string& rule, std::int64_t now);

  Expected<Learned> learned() const { return read_learned(database_); }
  const Database& database() const { return database_; }
  std::int64_t last_id() const { return newest_.id; }
  const Link& newest() const { return newest_; }

 private:
  Writer(std::filesystem::path path, Options options, FileLock lock, Database database);

  Expected<void> begin();
  Expected<void> compare(const Expected<std::optional<LearnedCopy>>& copy);
  Expected<void> restore(const Learned& learned);
  void copy_learned();
  void move_wal();
  Expected<void> write(const Batch& batch, std::int64_t now);
  Expected<void> insert(Entry entry);
  Expected<void> keep(const Learned& learned, std::int64_t now);
  Expected<void> keep(const std::vector<LearnedCoincidence>& coincidences);
  Expected<void> drop_old(std::int64_t now);
  Expected<void> check_name() const;

  std::filesystem::path path_;
  Options options_;
  FileLock lock_;
  Database database_;
  std::optional<Statement> insert_;
  Hasher hasher_;
  Link newest_;
  std::int64_t session_ = 0;  // the newest of its rows; 0: there is none
  bool wants_new_session_ = false;
  bool is_copy_due_ = true;
  std::string copy_trouble_;
  bool is_damaged_ = false;
  std::string remark_;
  std::filesystem::path aside_;
  std::uint64_t inode_ = 0;
};

}  // namespace culprit::journal
