// For tests: a folder with bags, as ros2 bag record writes them.
#pragma once

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/database.h"
#include "rtps/cdr.h"

namespace culprit::bag::test {

using culprit::test::value_of;

// Of a std_msgs/Float64.
inline ros2::Bytes number(double value) {
  ros2::Bytes bytes = {0, 1, 0, 0};
  std::array<std::uint8_t, 8> raw{};
  std::memcpy(raw.data(), &value, 8);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
  return bytes;
}

inline std::string_view text_of(const ros2::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
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
