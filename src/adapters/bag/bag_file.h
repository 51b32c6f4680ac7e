// A rosbag2 recording: its topics, and its messages in the order of their times.
//
// A bag is one file in SQLite3 storage or MCAP, or a folder of them that were split while
// recording; each may be compressed with Zstandard as a whole (`.zstd`), or message by message.
// What is in it came from elsewhere and is not trusted: what is whole is read, and what is not is
// said.
#pragma once

#include <filesystem>

#include "bag/bag_contents.h"
#include "bag/decompression.h"
#include "base/expected.h"

namespace culprit::bag {

// Whether `path` looks like a bag rather than like a journal.
bool is_bag(const std::filesystem::path& path);

class BagFile {
 public:
  struct Limits {
    std::size_t most_memory = std::size_t{256} << 20;  // bytes, of a chunk or a message
  };

  // Errors: there is no such bag, or nothing of it can be read.
  static Expected<BagFile> open(const std::filesystem::path& path, Limits limits);
  static Expected<BagFile> open(const std::filesystem::path& path) { return open(path, {}); }

  // May grow with each message. At an address that stays.
  const BagContents& contents() const { return *contents_; }

  // False at the end. Times never go back: a message that comes after a later one counts at the
  // time of that.
  bool next(BagMessage& message);

  // Messages whose time was earlier than that of one before them.
  std::uint64_t out_of_order() const { return out_of_order_; }

 private:
  BagFile() = default;
  Expected<void> open_next_part();
  bool next_of_part(BagMessage& message);
  bool is_usable(BagMessage& message);

  Limits limits_;
  std::unique_ptr<BagContents> contents_ = std::make_unique<BagContents>();
  std::vector<std::filesystem::path> parts_;
  std::size_t next_part_ = 0;
  std::unique_ptr<Storage> part_;
  Decompressor decompress_;
  std::string decompressed_;
  std::int64_t last_ = 0;
  std::uint64_t out_of_order_ = 0;
};

}  // namespace culprit::bag
