// Bags as ros2 bag record writes them: what rules see in them, and what becomes of broken ones.
#include "bag/bag_reading.h"

#include <array>
#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::bag {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

template <class T>
T value_of(Expected<T> expected) {
  if (!expected) throw std::runtime_error(expected.error());
  return std::move(*expected);
}

class BagTest : public testing::Test {
 protected:
  BagTest() {
    std::string name = (fs::temp_directory_path() / "culprit-bag-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~BagTest() override { fs::remove_all(folder_); }

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
  static void add(journal::Database& database, int topic, std::int64_t at,
                  const ros2::Bytes& bytes) {
    auto insert = value_of(
        database.prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)"));
    insert.bind(1, std::int64_t{topic}).bind(2, at);
    insert.bind_blob(3, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    EXPECT_TRUE(insert.step());
  }

  fs::path folder_;
};

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
SIGNAL visibility TOPIC /water_visibility FIELD data
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy
RULE R
  POLICIES ERROR
  TRIGGER visibility < 1 || entropy > 1 || lifecycle(camera) != "active" || age(/lidar) > 1s
    STRATEGY restart 50 10
      ADAPTATION camera restart 2
)";

ros2::Bytes number(double value) {
  ros2::Bytes bytes = {0, 1, 0, 0};
  std::array<std::uint8_t, 8> raw{};
  std::memcpy(raw.data(), &value, 8);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
  return bytes;
}

TEST_F(BagTest, ShowsTopicsFieldsDiagnosticsAndLifecyclesInTheOrderOfTime) {
  {
    auto second = make("bag_10.db3");
    add(second, 1, 400, number(0.5));
    auto first = make("bag_9.db3");
    ros2::msg::TransitionEvent event;
    event.goal_state.label = "active";
    add(first, 2, 300, ros2::encode(event));
    add(first, 1, 100, number(2.5));
    ros2::msg::DiagnosticArray array;
    array.status.resize(1);
    array.status[0].name = "segmentation";
    array.status[0].values = {{"entropy", "0.25"}};
    add(first, 3, 200, ros2::encode(array));
    add(first, 1, -5, number(9));            // no recorder writes that
    add(first, 3, 250, ros2::Bytes(7, 99));  // nor that
  }
  const auto checked = check(Source("t", kRules));
  ros2::MessageLibrary library;
  BagFile bag = value_of(BagFile::open(folder_));
  BagReading reading(*checked.rules, bag.topics(), library);
  EXPECT_THAT(reading.missing(), testing::ElementsAre("topic /lidar"));

  std::vector<Observation> seen;
  BagMessage message;
  while (value_of(bag.next(message))) reading.read(message, seen);
  std::vector<std::pair<std::int64_t, std::string>> said;
  for (const Observation& o : seen) {
    const std::int64_t at = o.at.time_since_epoch().count();
    if (const auto* signal = std::get_if<SignalRead>(&o.what))
      said.emplace_back(at, to_string(signal->value));
    if (std::holds_alternative<NodeAppeared>(o.what)) said.emplace_back(at, "node");
    if (const auto* state = std::get_if<LifecycleRead>(&o.what))
      said.emplace_back(at, state->state == Lifecycle::kActive ? "active" : "?");
  }
  const std::vector<std::pair<std::int64_t, std::string>> expected = {
      {100, "2.5"}, {200, "\"0.25\""}, {300, "node"}, {300, "active"}, {400, "0.5"}};
  EXPECT_EQ(said, expected);
}

TEST_F(BagTest, SaysWhyABagCannotBeRead) {
  const auto nowhere = BagFile::open(folder_ / "nowhere.db3");
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error(), HasSubstr("there is no such bag"));
  const auto empty = BagFile::open(folder_);
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error(), HasSubstr("no .db3 file"));
  std::ofstream(folder_ / "a.mcap") << "MCAP";
  const auto mcap = BagFile::open(folder_);
  ASSERT_FALSE(mcap);
  EXPECT_THAT(mcap.error(), HasSubstr("ros2 bag convert"));
  std::ofstream(folder_ / "a.db3") << "no database at all, but long enough to be looked at";
  EXPECT_FALSE(BagFile::open(folder_ / "a.db3"));
  (void)value_of(journal::Database::open(folder_ / "b.db3", journal::Database::Mode::kWrite))
      .run("CREATE TABLE t(a)");
  const auto foreign = BagFile::open(folder_ / "b.db3");
  ASSERT_FALSE(foreign);
  EXPECT_THAT(foreign.error(), HasSubstr("it is no bag"));
}

}  // namespace
}  // namespace culprit::bag
