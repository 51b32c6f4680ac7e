// A rosbag2 recording in SQLite3 storage: its topics, and its messages in the order of their times.
//
// A bag is one .db3 file, or a folder of them that were split while recording. What is in it came
// from elsewhere and is not trusted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "journal/database.h"

namespace culprit::bag {

struct BagTopic {
  std::string name;
  std::string type;  // "sensor_msgs/msg/Image"
};

struct BagMessage {
  std::int64_t at = 0;     // nanoseconds since 1970, as recorded
  std::size_t topic = 0;   // in BagFile::topics()
  std::string_view bytes;  // CDR; valid until the next message
};

// Whether `path` looks like a bag rather than like a journal.
bool is_bag(const std::filesystem::path& path);

class BagFile {
 public:
  // Errors: there is no such bag, it has another storage (MCAP), or it is compressed.
  static Expected<BagFile> open(const std::filesystem::path& path);

  const std::vector<BagTopic>& topics() const { return topics_; }

  // False at the end.
  Expected<bool> next(BagMessage& message);

 private:
  struct Part {
    journal::Database database;
    std::vector<std::pair<std::int64_t, std::size_t>> topics;  // its number -> ours
  };

  BagFile() = default;
  Expected<void> add(const std::filesystem::path& path);
  std::size_t place_of(BagTopic topic);

  std::vector<BagTopic> topics_;
  std::vector<Part> parts_;
  std::size_t part_ = 0;
  std::optional<journal::Statement> rows_;  // of the part
};

}  // namespace culprit::bag
