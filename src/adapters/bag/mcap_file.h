// A file in MCAP (mcap.dev/spec, version 0): recorded messages in chunks, which may be compressed.
//
// It is read from its beginning to its end, and never by its index: so one that was never finished,
// or is damaged at its end, shows all that is whole in it. In memory there is one chunk at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <unordered_map>
#include <vector>

#include "bag/bag_contents.h"
#include "bag/byte_source.h"
#include "bag/decompression.h"
#include "base/expected.h"

namespace culprit::bag {

class McapFile : public Storage {
 public:
  // `contents` must outlive the file. Chunks and messages of more than `most` bytes are left out.
  // Errors: it cannot be opened, or is not MCAP.
  static Expected<std::unique_ptr<Storage>> open(const std::filesystem::path& path,
                                                 BagContents& contents, std::size_t most);

  bool next(BagMessage& message) override;

 private:
  // Where a message is in records_.
  struct Located {
    std::uint64_t at = 0;
    std::size_t topic = 0;
    std::size_t offset = 0;
    std::size_t size = 0;
  };
  struct RecordHead {
    std::uint8_t code = 0;
    std::uint64_t size = 0;
    std::uint64_t place = 0;  // of its first byte in the file
    std::uint32_t checksum_before = 0;
  };

  McapFile(ByteSource source, std::string name, BagContents& contents, std::size_t most);

  bool begin();
  void read_record();
  void read_wanted(const RecordHead& head);
  void read_data_end(const RecordHead& head, std::string_view body);
  void read_chunk(const RecordHead& head, std::string_view body, bool is_whole);
  void read_chunk_records(const RecordHead& head, bool is_whole);
  // `body` lies in records_.
  void read_content(std::uint8_t code, std::string_view body);
  void read_schema(std::string_view body);
  void read_channel(std::string_view body);
  void read_message(std::string_view body);
  void finish();

  // From the file; false if it ends before.
  bool take(char* to, std::size_t size);
  bool take(std::string& to, std::uint64_t size);
  bool pass(std::uint64_t size);

  void lose(const RecordHead& head, const std::string& what);
  void lose_rest(const RecordHead& head, const std::string& why);

  ByteSource source_;
  std::string name_;
  BagContents& contents_;
  std::size_t most_;
  Decompressor decompress_;
  std::uint32_t checksum_ = 0;                               // of all bytes so far
  std::unordered_map<std::uint16_t, std::string> types_;     // by schema
  std::unordered_map<std::uint16_t, std::size_t> channels_;  // to topics
  std::string body_;
  std::string chunk_;
  std::string_view records_;      // that located_ is about: body_ or chunk_
  std::vector<Located> located_;  // in the order of their times
  std::size_t given_ = 0;         // of located_
  std::uint64_t message_count_ = 0;
  std::uint64_t expected_count_ = 0;  // by the statistics of the recorder; 0: it has none
  bool has_data_end_ = false;
  bool is_at_end_ = false;
};

}  // namespace culprit::bag
