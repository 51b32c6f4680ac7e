#include "replay/test_disk.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <sqlite3.h>

namespace culprit::replay::test {
namespace {

PowerCutDisk* the_disk = nullptr;
sqlite3_vfs* real_vfs = nullptr;

// SQLite's file, and behind it in the same memory the real one.
struct Seen {
  sqlite3_file base;
  const char* path;  // null: not looked at
};
sqlite3_file* real_of(sqlite3_file* file) {
  return reinterpret_cast<sqlite3_file*>(reinterpret_cast<Seen*>(file) + 1);
}
const char* path_of(sqlite3_file* file) { return reinterpret_cast<Seen*>(file)->path; }
const sqlite3_io_methods& methods_of(sqlite3_file* file) { return *real_of(file)->pMethods; }

const sqlite3_io_methods kMethods = {
    3,
    [](sqlite3_file* f) { return methods_of(f).xClose(real_of(f)); },
    [](sqlite3_file* f, void* to, int size, sqlite3_int64 at) {
      return methods_of(f).xRead(real_of(f), to, size, at);
    },
    [](sqlite3_file* f, const void* from, int size, sqlite3_int64 at) {
      if (path_of(f) != nullptr)
        the_disk->wrote(path_of(f), static_cast<std::size_t>(at),
                        {static_cast<const char*>(from), static_cast<std::size_t>(size)});
      return methods_of(f).xWrite(real_of(f), from, size, at);
    },
    [](sqlite3_file* f, sqlite3_int64 size) {
      if (path_of(f) != nullptr) the_disk->truncated(path_of(f), static_cast<std::size_t>(size));
      return methods_of(f).xTruncate(real_of(f), size);
    },
    [](sqlite3_file* f, int flags) {
      if (path_of(f) != nullptr) the_disk->synced(path_of(f));
      return methods_of(f).xSync(real_of(f), flags);
    },
    [](sqlite3_file* f, sqlite3_int64* size) { return methods_of(f).xFileSize(real_of(f), size); },
    [](sqlite3_file* f, int lock) { return methods_of(f).xLock(real_of(f), lock); },
    [](sqlite3_file* f, int lock) { return methods_of(f).xUnlock(real_of(f), lock); },
    [](sqlite3_file* f, int* out) { return methods_of(f).xCheckReservedLock(real_of(f), out); },
    [](sqlite3_file* f, int op, void* arg) {
      return methods_of(f).xFileControl(real_of(f), op, arg);
    },
    [](sqlite3_file* f) { return methods_of(f).xSectorSize(real_of(f)); },
    [](sqlite3_file* f) { return methods_of(f).xDeviceCharacteristics(real_of(f)); },
    [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
      return methods_of(f).xShmMap(real_of(f), page, size, extend, out);
    },
    [](sqlite3_file* f, int offset, int n, int flags) {
      return methods_of(f).xShmLock(real_of(f), offset, n, flags);
    },
    [](sqlite3_file* f) { methods_of(f).xShmBarrier(real_of(f)); },
    [](sqlite3_file* f, int remove) { return methods_of(f).xShmUnmap(real_of(f), remove); },
    [](sqlite3_file* f, sqlite3_int64 at, int size, void** out) {
      return methods_of(f).xFetch(real_of(f), at, size, out);
    },
    [](sqlite3_file* f, sqlite3_int64 at, void* page) {
      return methods_of(f).xUnfetch(real_of(f), at, page);
    },
};

int open_seen(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out) {
  auto* seen = new (file) Seen{};
  const int code = real_vfs->xOpen(real_vfs, name, real_of(file), flags, out);
  const bool is_looked_at = (flags & (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL)) != 0;
  seen->path = is_looked_at ? name : nullptr;
  if (real_of(file)->pMethods != nullptr) seen->base.pMethods = &kMethods;
  return code;
}

int delete_seen(sqlite3_vfs*, const char* name, int syncs) {
  the_disk->removed(name);
  return real_vfs->xDelete(real_vfs, name, syncs);
}

}  // namespace

PowerCutDisk::PowerCutDisk() {
  if (the_disk != nullptr) throw std::logic_error("there is such a disk already");
  the_disk = this;
  real_vfs = sqlite3_vfs_find(nullptr);
  vfs_ = std::make_unique<sqlite3_vfs>(*real_vfs);
  vfs_->zName = "culprit-power-cut";
  vfs_->pNext = nullptr;
  vfs_->szOsFile = static_cast<int>(sizeof(Seen)) + real_vfs->szOsFile;
  vfs_->xOpen = open_seen;
  vfs_->xDelete = delete_seen;
  sqlite3_vfs_register(vfs_.get(), 1);
}

PowerCutDisk::~PowerCutDisk() {
  sqlite3_vfs_unregister(vfs_.get());
  sqlite3_vfs_register(real_vfs, 1);
  the_disk = nullptr;
}

void PowerCutDisk::apply(const Write& write, std::string& content) {
  if (write.is_truncation) return content.resize(write.at);
  content.resize(std::max(content.size(), write.at + write.bytes.size()));
  std::memcpy(content.data() + write.at, write.bytes.data(), write.bytes.size());
}

void PowerCutDisk::wrote(const std::string& path, std::size_t at, std::string bytes) {
  const MutexLock lock(mutex_);
  files_[path].later.push_back({false, at, std::move(bytes)});
}

void PowerCutDisk::truncated(const std::string& path, std::size_t size) {
  const MutexLock lock(mutex_);
  files_[path].later.push_back({true, size, {}});
}

void PowerCutDisk::synced(const std::string& path) {
  const MutexLock lock(mutex_);
  File& file = files_[path];
  for (const Write& write : file.later) apply(write, file.synced);
  file.later.clear();
}

void PowerCutDisk::removed(const std::string& path) {
  const MutexLock lock(mutex_);
  files_.erase(path);
}

void PowerCutDisk::cut(const std::filesystem::path& from, const std::filesystem::path& to,
                       std::mt19937& random) {
  const MutexLock lock(mutex_);
  for (const char* part : {"", "-wal"}) {
    std::filesystem::remove(to.string() + part);
    const auto found = files_.find(from.string() + part);
    if (found == files_.end()) continue;
    std::string content = found->second.synced;
    std::vector<Write> later = found->second.later;
    std::shuffle(later.begin(), later.end(), random);
    for (const Write& write : later) {
      switch (random() % 3) {
        case 0:
          break;
        case 1:
          apply(write, content);
          break;
        default:
          for (std::size_t at = 0; at < write.bytes.size(); at += kSector) {
            if (random() % 2 == 0)
              apply({false, write.at + at, write.bytes.substr(at, kSector)}, content);
          }
      }
    }
    std::ofstream(to.string() + part, std::ios::binary) << content;
  }
}

}  // namespace culprit::replay::test
