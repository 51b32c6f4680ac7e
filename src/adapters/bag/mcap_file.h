// A file in MCAP (mcap.dev/spec, version 0): recorded messages in chunks, which may be compressed.
//
// The survey goes through its records from the beginning to the end, and never by its index: so one
// that was never finished, or is damaged at its end, shows all that is whole in it. Each chunk is a
// block, and so is each stretch of messages outside of chunks. Blocks are then read by the times of
// their first messages, so that blocks that overlap, or stand in another order, give the messages in
// the order of their times.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

#include "bag/byte_source.h"
#include "bag/decompression.h"
#include "bag/storage.h"
#include "base/expected.h"

namespace culprit::bag {

class McapFile : public Storage {
 public:
  // `contents` must outlive the file. Chunks and messages of more than `most` bytes are left out.
  // Errors: it cannot be opened, or is not MCAP.
  static Expected<std::unique_ptr<Storage>> open(const std::filesystem::path& path,
                                                 BagContents& contents, std::size_t most);

  void survey(PieceFinder& finder) override;
  void follow(TimeLine line) override;
  bool next(BagMessage& message) override;
  std::uint64_t late() const override { return late_; }

 private:
  struct RecordHead {
    std::uint8_t code = 0;
    std::uint64_t size = 0;
    std::uint64_t place = 0;  // of its first byte in the file
  };
  struct Block {
    std::uint64_t place = 0;  // of a chunk's content, or of the first record
    std::uint64_t size = 0;
    std::uint64_t head = 0;  // place of the record, for people
    bool is_chunk = false;
    bool is_whole = true;        // all its bytes are in the file
    std::int64_t first = 0;      // the earliest time in it
    std::int64_t last = 0;       // the latest one
    std::uint64_t messages = 0;  // 0: not known
  };
  // Where a message is in the bytes of its block.
  struct Located {
    std::int64_t at = 0;  // with its offset
    std::int64_t recorded_at = 0;
    std::int64_t ordinal = 0;
    std::size_t topic = 0;
    std::size_t offset = 0;
    std::size_t size = 0;
  };
  struct OpenBlock {
    std::string bytes;
    std::vector<Located> messages;  // in the order of their times, once it is sorted
    std::size_t given = 0;
    bool is_after_hole = false;
  };
  enum class Telling : std::uint8_t { kNothing, kLosses };

  McapFile(ByteSource source, std::filesystem::path path, BagContents& contents, std::size_t most);

  bool begin();
  // The survey.
  void find_blocks();
  bool take_in_record(const RecordHead& head);
  bool take_in_chunk(const RecordHead& head);
  bool take_in_bare(const RecordHead& head);
  bool has_plausible_times() const;
  void look_into(std::size_t block, PieceFinder& finder);
  void check_bytes(const RecordHead& head);
  // A block's messages in the order of the file.
  bool load(std::size_t block, OpenBlock& opened, Telling telling);
  bool decompress_chunk(const Block& block, std::string& into, Telling telling);
  void read_records(std::size_t block, OpenBlock& opened, Telling telling);
  void read_schema(std::string_view body);
  void read_channel(std::string_view body);
  void read_message(std::string_view body, std::int64_t ordinal, OpenBlock& opened,
                    Telling telling);
  void open_next();
  bool wants_next(const OpenBlock* earliest) const;

  // From the file; false if it ends before.
  bool take(std::string& to, std::uint64_t size);

  void lose(const Block& block, const std::string& what);
  void lose_rest(const RecordHead& head, const std::string& why);

  ByteSource source_;
  std::filesystem::path path_;
  std::string name_;
  BagContents& contents_;
  std::size_t most_;
  Decompressor decompress_;
  std::unordered_map<std::uint16_t, std::string> types_;     // by schema
  std::unordered_map<std::uint16_t, std::size_t> channels_;  // to topics
  std::vector<Block> blocks_;                                // in the order of the file
  bool is_bare_open_ = false;                                // the last one may still grow
  TimeLine line_;
  std::vector<std::size_t> order_;  // in which blocks are read
  std::size_t next_block_ = 0;      // in order_
  std::list<OpenBlock> open_;
  std::size_t open_bytes_ = 0;
  std::vector<std::string> spare_;  // buffers
  std::string body_;
  bool is_after_hole_ = false;
  bool was_looked_into_ = false;  // the survey read all messages
  std::int64_t newest_ = 0;
  std::uint64_t late_ = 0;
  std::uint64_t message_count_ = 0;
  std::uint64_t expected_count_ = 0;  // by the statistics of the recorder; 0: it has none
  bool has_data_end_ = false;
  bool is_at_end_ = false;
};

}  // namespace culprit::bag
