// Writes a shard file, or goes on with one that was interrupted.
//
// A run is in the file as soon as append() returns, and survives the end of the process. The file
// is locked meanwhile: a second process is turned away.
#pragma once

#include <filesystem>
#include <functional>

#include "base/invariant.h"
#include "shards/shard_file.h"

namespace culprit::study {

template <class C>
class ShardWriter {
 public:
  using Run = typename ShardKind<C>::Run;

  // Makes the file, or checks that it belongs to the same campaign and shard, drops half a line at
  // its end, and goes on behind its last run. Calls `found`, if any, for each run that is there
  // already, in order. An error leaves the file as it was.
  using Found = std::function<void(const Run&)>;
  static Expected<ShardWriter> open(const std::filesystem::path& path, const ShardHeader<C>& header,
                                    const Found& found = {});

  ShardWriter(ShardWriter&& other) noexcept;
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;
  ShardWriter& operator=(ShardWriter&&) = delete;
  ~ShardWriter();

  std::uint64_t done() const { return done_; }
  std::uint64_t size() const { return study::size(header_.shard, header_.campaign); }
  bool is_complete() const { return done_ == size(); }
  // The run that append() wants. @pre !is_complete()
  RunId next() const {
    CULPRIT_ASSERT(!is_complete());
    return header_.campaign[campaign_index(header_.shard, done_)];
  }

  // What next() yielded; behind the last one goes the line that ends the file. An error: a number
  // is not finite, or the file cannot be written; then the run counts as not done.
  // @pre !is_complete()
  Expected<void> append(const Run& run);

 private:
  ShardWriter(int file, std::filesystem::path path, ShardHeader<C> header);

  Expected<void> resume(const Found& found);
  Expected<void> write(const std::string& lines);
  Expected<void> drop_rest();  // behind the last whole line
  Error error(const std::string& what) const;

  int file_ = -1;
  std::filesystem::path path_;
  ShardHeader<C> header_;
  std::uint64_t done_ = 0;
  std::uint64_t bytes_ = 0;  // written and whole
};

}  // namespace culprit::study
