// Writes a file in MCAP (mcap.dev/spec, version 0) as it grows: messages in chunks, each with the
// schemas and channels that it needs. So all chunks from before a crash can be read without the
// rest.
//
//     McapWriter writer([&](std::string_view bytes) { return file.write(bytes); }, "ros2", "culprit 0.1.0");
//     const auto schema = writer.add_schema({"std_msgs/msg/String", "ros2msg", "string data\n"});
//     const auto channel = writer.add_channel({schema, "/chatter", "cdr", {}});
//     writer.add({channel, 0, now, now}, payload);
//     writer.end();
//
// A chunk goes to the sink in one piece, with its index behind it. The summary at the end is for
// readers with an index: schemas, channels, statistics, and where the chunks are.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace culprit::recorder {

// One thread.
class McapWriter {
 public:
  // Takes all of the bytes, or gives false: then nothing is written any more.
  using Sink = std::function<bool(std::string_view bytes)>;
  using Texts = std::map<std::string, std::string>;

  struct Schema {
    std::string name;      // "sensor_msgs/msg/Image"
    std::string encoding;  // "ros2msg"; empty: what it looks like is not known, and `text` is empty
    std::string text;
  };
  struct Channel {
    std::uint16_t schema = 0;  // of add_schema()
    std::string topic;
    std::string encoding;  // of its messages: "cdr"
    Texts metadata;
  };
  struct Head {
    std::uint16_t channel = 0;   // of add_channel()
    std::uint32_t sequence = 0;  // 0: not known
    std::int64_t logged = 0;     // nanoseconds since 1970
    std::int64_t published = 0;
  };

  // A chunk is full with so many bytes, before they are compressed.
  static constexpr std::size_t kChunkSize = std::size_t{1} << 20;

  McapWriter(Sink sink, const std::string& profile, const std::string& library);

  // Ids count from 1. At most 65,535 of each; 0: there is no place for another.
  std::uint16_t add_schema(Schema schema);
  std::uint16_t add_channel(Channel channel);
  void add(const Head& head, std::string_view payload);
  // A record of its own, for programs that know it by its name. @pre no chunk is open: flush()
  void add_metadata(const std::string& name, const Texts& metadata);

  // Writes the chunk that is open, if there is one.
  void flush();
  // The last of it: flush(), and the summary.
  void end();

  // False once the sink has refused something.
  bool is_good() const { return is_good_; }
  // Bytes that the sink has taken, and those that wait for their chunk.
  std::uint64_t size() const { return written_ + chunk_.size(); }
  std::uint64_t messages() const { return messages_; }

 private:
  struct Entry {
    std::uint64_t logged;
    std::uint64_t offset;  // in the chunk
  };
  // The range of the messages' times.
  struct Span {
    std::uint64_t first = UINT64_MAX;
    std::uint64_t last = 0;
    void include(const Span& other);
    std::uint64_t begin() const { return first == UINT64_MAX ? 0 : first; }
  };

  void put(const std::string& bytes);
  std::string summary(std::uint64_t at) const;
  std::string statistics() const;

  const Sink sink_;
  bool is_good_ = true;
  std::uint64_t written_ = 0;
  std::uint32_t checksum_ = 0;  // of all that was written

  std::vector<std::string> schemas_;      // records
  std::vector<std::string> channels_;     // likewise
  std::vector<std::uint16_t> schema_of_;  // of each channel
  std::vector<std::uint64_t> counts_;     // messages of each channel
  std::uint64_t messages_ = 0;
  Span span_;
  std::vector<std::string> chunk_indexes_;     // records
  std::vector<std::string> metadata_indexes_;  // likewise

  std::string chunk_;
  Span chunk_span_;
  std::map<std::uint16_t, std::vector<Entry>> chunk_entries_;  // by channel
  std::vector<bool> is_schema_in_chunk_;
};

}  // namespace culprit::recorder
