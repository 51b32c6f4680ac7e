// For tests: a folder with bags, as ros2 bag record writes them.
#pragma once

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/database.h"
#include "rtps/cdr.h"

namespace culprit::bag::test {

using culprit::test::value_of;

// Of a std_msgs/Float64.
inline rtps::Bytes number(double value) {
  rtps::Bytes bytes = {0, 1, 0, 0};
  std::array<std::uint8_t, 8> raw{};
  std::memcpy(raw.data(), &value, 8);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
  return bytes;
}

inline std::string_view text_of(const rtps::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// One message of a recording that a test writes.
struct TestMessage {
  std::int64_t at = 0;  // ns
  std::string topic;
  std::string bytes;
};

// A whole recording. `types`: topics and what their messages are.
struct TestRecording {
  std::vector<std::pair<std::string, std::string>> types;
  std::vector<TestMessage> messages;  // in the order in which they are written
};

constexpr std::int64_t kBagStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kMillisecond = 1'000'000;

// /x at 10 Hz for 30 s: std_msgs/msg/Float64, 0 to 49 again and again.
inline TestRecording regular_recording(const std::string& topic = "/x") {
  TestRecording all{{{topic, "std_msgs/msg/Float64"}}, {}};
  for (int i = 0; i < 300; ++i)
    all.messages.push_back(
        {kBagStart + i * 100 * kMillisecond, topic, std::string(text_of(number(i % 50)))});
  return all;
}

// The schema of rosbag2_storage_sqlite3.
inline void write_db3(const std::filesystem::path& path, const TestRecording& recording) {
  auto database = value_of(journal::Database::open(path, journal::Database::Mode::kWrite));
  EXPECT_TRUE(database.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
      "INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
      "PRAGMA journal_mode = OFF; BEGIN"));
  std::map<std::string, std::int64_t> ids;
  for (const auto& [topic, type] : recording.types) {
    ids[topic] = static_cast<std::int64_t>(ids.size()) + 1;
    auto insert = value_of(database.prepare("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')"));
    insert.bind(1, ids[topic]).bind(2, topic).bind(3, type);
    EXPECT_TRUE(insert.step());
  }
  auto insert =
      value_of(database.prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)"));
  for (const TestMessage& each : recording.messages) {
    insert.bind(1, ids[each.topic]).bind(2, each.at).bind_blob(3, each.bytes);
    EXPECT_TRUE(insert.step());
  }
  EXPECT_TRUE(database.run("COMMIT"));
}

// As rosbag2 writes metadata.yaml.
inline void write_metadata(const std::filesystem::path& folder,
                           const std::vector<std::string>& files, std::size_t messages) {
  std::ofstream out(folder / "metadata.yaml");
  out << "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
         "  message_count: "
      << messages << "\n  topics_with_message_count:\n    []\n  relative_file_paths:\n";
  for (const std::string& each : files) out << "    - " << each << "\n";
}

class BagTest : public testing::Test {
 protected:
  // The schema of rosbag2_storage_sqlite3.
  journal::Database make(const std::string& name) {
    auto database =
        value_of(journal::Database::open(folder_ / name, journal::Database::Mode::kWrite));
    EXPECT_TRUE(database.run(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
        "INTEGER NOT NULL, data BLOB NOT NULL);"
        "INSERT INTO topics VALUES(1, '/water_visibility', 'std_msgs/msg/Float64', 'cdr', ''),"
        "(2, '/camera/transition_event', 'lifecycle_msgs/msg/TransitionEvent', 'cdr', ''),"
        "(3, '/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', 'cdr', '')"));
    return database;
  }
  static void add(journal::Database& database, int topic, std::int64_t at, std::string_view bytes) {
    auto insert = value_of(
        database.prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)"));
    insert.bind(1, std::int64_t{topic}).bind(2, at).bind_blob(3, bytes);
    EXPECT_TRUE(insert.step());
  }

  std::filesystem::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string bytes_of(const std::string& name) {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const culprit::test::TestFolder own_;
  const std::filesystem::path folder_ = own_.path();
};

}  // namespace culprit::bag::test
