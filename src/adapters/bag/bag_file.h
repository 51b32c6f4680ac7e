// A rosbag2 recording: its topics, and its messages in the order of their times.
//
// A bag is one file in SQLite3 storage or MCAP, or a folder of them that were split while
// recording; each may be compressed with Zstandard as a whole (`.zstd`), or message by message.
// Its content came from elsewhere and is not trusted: the reader gives all that is whole, and reports
// the rest.
//
// Where the recorder's clock was set, or it paused for long, time goes on from message to message
// (time_line.h), and the jump is among contents().jumps().
#pragma once

#include <filesystem>
#include <span>

#include "bag/bag_contents.h"
#include "bag/bag_parts.h"
#include "bag/decompression.h"
#include "bag/storage.h"
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
  // Several recordings, merged by time. Errors: as above, of any of them.
  static Expected<BagFile> open(std::span<const std::filesystem::path> paths, Limits limits);

  // May grow with each message. At an address that stays.
  const BagContents& contents() const { return *contents_; }

  // False at the end. Times never go back: a message that comes after a later one counts at the
  // time of that.
  bool next(BagMessage& message);

  // Messages whose time was earlier than that of one before them, and could not be sorted.
  std::uint64_t out_of_order() const { return out_of_order_; }

  // Messages so far that were written after one of a later time.
  std::uint64_t late() const;

  struct Part {
    std::filesystem::path path;
    PartFormat format = PartFormat::kSqlite;
    std::uint64_t bytes = 0;  // of the file
    std::int64_t first = 0;   // as BagMessage::at
    std::int64_t last = 0;
  };
  // Those that can be read, by their first messages.
  std::vector<Part> parts() const;

 private:
  struct Open {
    BagPart part;
    TimeLine line;
    std::unique_ptr<Storage> storage;
    bool has_head = false;
    BagMessage head{};
  };

  BagFile() = default;
  Expected<std::unique_ptr<Storage>> open_part(const BagPart& part);
  Expected<void> add(const std::filesystem::path& path);
  void straighten_parts(std::vector<Open>& recording, bool is_ordered);
  void begin(Open& part);
  void take_head(Open& part);
  bool next_of_parts(BagMessage& message);
  bool is_usable(BagMessage& message);
  void count_what_is_missing();

  Limits limits_;
  std::unique_ptr<BagContents> contents_ = std::make_unique<BagContents>();
  std::vector<Open> parts_;  // by the first message
  std::size_t next_part_ = 0;
  Open* given_ = nullptr;  // whose head was given last
  Decompressor decompress_;
  std::string decompressed_;
  std::optional<std::uint64_t> expected_count_;
  std::uint64_t count_ = 0;
  std::int64_t last_ = 0;
  bool is_after_hole_ = false;
  std::uint64_t out_of_order_ = 0;
  std::uint64_t late_ = 0;  // of surveys, and of parts that are done
};

}  // namespace culprit::bag
