// For tests of a power cut: a disk that keeps only what was synced, and whatever it likes of the
// rest.
//
//     PowerCutDisk disk;                       // from now on SQLite writes through it
//     ...
//     disk.cut(journal, remains, random);      // what the machine finds when it is started again
//
// For writes to a database and its write-ahead log since the last sync of each: every write is there or not, or some of its sectors are; later writes may be
// there without earlier ones. SQLite still works on the real files meanwhile.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "base/mutex.h"

struct sqlite3_vfs;

namespace culprit::replay::test {

class PowerCutDisk {
 public:
  static constexpr std::size_t kSector = 512;

  // One at a time. Files that were open before are not seen.
  PowerCutDisk();
  ~PowerCutDisk();
  PowerCutDisk(const PowerCutDisk&) = delete;

  // Writes the database `from` and its log as a power cut now may leave them to `to`.
  void cut(const std::filesystem::path& from, const std::filesystem::path& to,
           std::mt19937& random);

  // For the files behind it.
  void wrote(const std::string& path, std::size_t at, std::string bytes);
  void truncated(const std::string& path, std::size_t size);
  void synced(const std::string& path);
  void removed(const std::string& path);

 private:
  struct Write {
    bool is_truncation = false;
    std::size_t at = 0;  // or the new size
    std::string bytes;
  };
  struct File {
    std::string synced;
    std::vector<Write> later;
  };
  static void apply(const Write& write, std::string& content);

  std::unique_ptr<sqlite3_vfs> vfs_;
  Mutex mutex_;
  std::map<std::string, File> files_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::replay::test
