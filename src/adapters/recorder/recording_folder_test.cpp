#include "recorder/recording_folder.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::recorder {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kWhen = 1'795'633'397'042'000'000;  // 2026-11-25, 19:03:17.042

RecordingFolder::SpaceOf plenty() {
  return [](const std::filesystem::path&) {
    return Expected<RecordingFolder::Space>({1'000'000'000'000, 900'000'000'000});
  };
}

struct RecordingFolders : testing::Test {
  std::string record(int minute, std::size_t bytes) const {
    const std::string name = recording_name("robot", kWhen + minute * 60'000'000'000, "Dead");
    std::ofstream(own / name) << std::string(bytes, 'x');
    return name;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const StoredRecording& each : recordings_in(own.path()))
      all.push_back(each.path.filename());
    return all;
  }
  test::TestFolder own;
};

TEST(RecordingName, SaysWhenAndWhyAndIsReadBack) {
  EXPECT_EQ(recording_name("sub marine", kWhen, "Camera_Dead"),
            "sub-marine_20261125T190317.042Z_Camera-Dead.mcap");
  EXPECT_EQ(when_recorded(recording_name("", kWhen, "../../etc")), kWhen);
  for (const char* other : {"notes.mcap", "a_b_c.mcap", "robot_20261125T190317.042Z_Dead.mcap.part",
                            "robot_20261345T190317.042Z_Dead.mcap", "_", ""})
    EXPECT_EQ(when_recorded(other), std::nullopt) << other;
}

TEST_F(RecordingFolders, RemoveTheOldestForTheBudget) {
  record(1, 400);
  const std::string second = record(2, 400);
  std::ofstream(own / "mine.mcap") << std::string(5000, 'x');
  const RecordingFolder folder(own.path(), 1000, plenty());
  const std::string third = record(3, 100);
  ASSERT_TRUE(folder.make_room(300, own / third));
  EXPECT_THAT(names(), ElementsAre(second, third));
  EXPECT_TRUE(std::filesystem::exists(own / "mine.mcap")) << "it is no recording";
}

TEST_F(RecordingFolders, NeverRemoveTheOneThatIsWritten) {
  const std::string only = record(1, 900);
  const RecordingFolder folder(own.path(), 1000, plenty());
  const auto room = folder.make_room(200, own / only);
  ASSERT_FALSE(room);
  EXPECT_THAT(room.error(), HasSubstr("--record-disk"));
  EXPECT_THAT(names(), ElementsAre(only));
}

TEST_F(RecordingFolders, LeaveTheRobotItsLastFreeSpace) {
  record(1, 100'000);
  const std::string own_one = record(2, 10);
  std::uint64_t freed = 0;
  const RecordingFolder folder(own.path(), 1'000'000, [&](const std::filesystem::path&) {
    freed = recordings_in(own.path()).size() < 2 ? 100'000 : 0;
    return Expected<RecordingFolder::Space>({2'000'000'000, 200'000'500 + freed});
  });
  EXPECT_TRUE(folder.make_room(500, own / own_one));
  EXPECT_EQ(names().size(), 2) << "a tenth stays free as it is";
  EXPECT_TRUE(folder.make_room(50'000, own / own_one));
  EXPECT_THAT(names(), ElementsAre(own_one)) << "the older one had to go";
  const auto room = folder.make_room(200'000, own / own_one);
  ASSERT_FALSE(room);
  EXPECT_THAT(room.error(), HasSubstr("200 MB stay free"));
}

TEST(RecordingFolder, LeavesAGigabyteOrATenthOfASmallDisk) {
  EXPECT_EQ(RecordingFolder::left_free({500'000'000'000, 0}), 1'000'000'000);
  EXPECT_EQ(RecordingFolder::left_free({4'000'000'000, 0}), 400'000'000);
}

}  // namespace
}  // namespace culprit::recorder
