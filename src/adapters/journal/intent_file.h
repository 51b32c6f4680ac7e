// The decisions and requests that the journal does not hold yet: "a.journal-intents".
//
// Before a request goes out that needs no disk (settled_here.h) its rows are here, by one write().
// From then on they are with the kernel, and outlive culprit however it ends; the journal follows
// within moments, and on the disk. This file is never synced: after a power cut it is read as far
// as it is whole, and no strategy is continued.
//
//     "culprit-intents1"  number (8 bytes) and hash (32 bytes) of a row of the journal: all below
//                         comes after it
//     part:  size (4 bytes)  SHA-256(hash of the part before | payload) (32 bytes)  payload
//            payload: time of the step (integer), then rows: at (integer), kind (text), body (text)
//     ...
//     0 (4 bytes): the end
//
// Sizes and numbers lowest byte first; the others as in bytes.h. The first part follows the hash of
// the 56 bytes before it. Once all parts are in the journal, the next one is written over the
// first, after a later row; older bytes may remain behind its end.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "journal/entry.h"
#include "journal/file_lock.h"
#include "journal/tables.h"

namespace culprit::journal {

std::filesystem::path intents_beside(const std::filesystem::path& journal);

// Rows as parts hold them.
void append_row(const Entry& row, std::string& rows);

class IntentFile {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 10;

  // Makes or empties the file beside `journal`, which exists, and gives it the journal's owner and
  // permissions. Its old content must be in the journal. Errors say why, with the path.
  static Expected<IntentFile> open(const std::filesystem::path& journal);

  // The beginning of such a file. It is made in advance, while no request waits for it.
  struct Head {
    Head() = default;
    explicit Head(const Link& newest);
    std::string bytes;
    Hash hash{};
  };
  // All parts are in the journal, and the row that `head` was made of: the next part is the first
  // one.
  void begin_after(Head head);

  // One more part, whole with the kernel when this returns. After an error it is not there, and the
  // parts before it are. @pre begin_after() was called
  Expected<void> append(Time step, std::string_view rows);

  // All parts are in the journal, and no more follow for now.
  void empty();

 private:
  IntentFile(std::filesystem::path path, FileLock file, std::uint64_t inode)
      : path_(std::move(path)), file_(std::move(file)), inode_(inode) {}

  std::filesystem::path path_;
  FileLock file_;
  std::uint64_t inode_;
  Hasher hasher_;
  Hash before_{};        // of the part before the next, or of the head
  std::size_t end_ = 0;  // where the next part comes
  std::string head_;     // to be written with the first part
  std::string bytes_;    // memory that is used again
};

// The content of such a file.
struct SavedIntents {
  Link after;               // the row of the journal that all of it comes after
  std::vector<Entry> rows;  // without `id`
  Time latest = kLongAgo;   // of the steps
  std::string damage;       // why there may have been more; empty: there was not
};

// Reads as far as it is whole; trusts nothing. Only events, intents and outcomes are rows here.
SavedIntents decode_intents(std::string_view bytes);

// If there is no such file, nothing is saved. Errors: it cannot be read, or is no such file.
Expected<SavedIntents> read_intents(const std::filesystem::path& path);

}  // namespace culprit::journal
