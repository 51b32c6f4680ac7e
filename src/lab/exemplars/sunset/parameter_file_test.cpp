#include "exemplars/sunset/parameter_file.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "exemplars/sunset/crash_at_start.h"

namespace culprit::sunset {
namespace {

namespace fs = std::filesystem;

using Folder = test::TestFolder;

ParameterFile open(const fs::path& path) {
  auto file = ParameterFile::open(path);
  EXPECT_TRUE(file) << file.error();
  return std::move(*file);
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ParameterFile, RemembersTheLastValueOfEachType) {
  const Folder folder;
  const fs::path path = folder / "camera.parameters";
  {
    ParameterFile file = open(path);
    EXPECT_FALSE(file.last("image_shift", std::int64_t{0}));
    EXPECT_TRUE(file.append("image_shift", std::int64_t{300}));
    EXPECT_TRUE(file.append("sync_issue", true));
    EXPECT_TRUE(file.append("image_degradation", 2.0));
    EXPECT_TRUE(file.append("topic_camera_input", std::string("a b")));
    EXPECT_TRUE(file.append("image_shift", std::int64_t{7}));
  }
  const ParameterFile file = open(path);
  EXPECT_EQ(file.last("image_shift", std::int64_t{0}), Value(std::int64_t{7}));
  EXPECT_EQ(file.last("sync_issue", false), Value(true));
  EXPECT_EQ(file.last("image_degradation", 0.0), Value(2.0));
  EXPECT_EQ(file.last("topic_camera_input", std::string()), Value(std::string("a b")));
  EXPECT_FALSE(file.last("image_shift", false)) << "not of that type";
}

TEST(ParameterFile, ReadsATextThatLooksLikeANumberAsAText) {
  const Folder folder;
  EXPECT_TRUE(open(folder / "f").append("name", std::string("12")));
  EXPECT_EQ(open(folder / "f").last("name", std::string()), Value(std::string("12")));
}

TEST(ParameterFile, RefusesATextOfSeveralLines) {
  const Folder folder;
  EXPECT_FALSE(open(folder / "f").append("name", std::string("a\nimage_shift 1")));
}

TEST(ParameterFile, CountsWholeLinesOnlyWhereverTheWriterWasKilled) {
  const Folder folder;
  const fs::path path = folder / "f";
  {
    ParameterFile file = open(path);
    EXPECT_TRUE(file.append("image_shift", std::int64_t{300}));
    EXPECT_TRUE(file.append("image_shift", std::int64_t{412}));
  }
  const std::string whole = content_of(path);
  const std::size_t line = whole.size() / 2;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, size);
    std::optional<Value> expected;
    if (size >= line) expected = std::int64_t{300};
    if (size == whole.size()) expected = std::int64_t{412};
    {
      ParameterFile file = open(path);
      EXPECT_EQ(file.last("image_shift", std::int64_t{0}), expected) << size;
      EXPECT_TRUE(file.append("image_shift", std::int64_t{5}));
    }
    EXPECT_EQ(open(path).last("image_shift", std::int64_t{0}), Value(std::int64_t{5})) << size;
  }
}

TEST(ParameterFile, SurvivesAKillInTheMiddle) {
  const Folder folder;
  const fs::path path = folder / "f";
  for (int round = 0; round < 5; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      ParameterFile file = open(path);
      for (std::int64_t i = 1000;; ++i) (void)file.append("image_shift", i);
    }
    while (!fs::exists(path) || fs::file_size(path) < 1000) usleep(100);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const auto last = open(path).last("image_shift", std::int64_t{0});
    ASSERT_TRUE(last);
    EXPECT_GE(std::get<std::int64_t>(*last), 1000);
    fs::remove(path);
  }
}

TEST(ParameterFile, IgnoresWhatIsNoneOfItsLines) {
  const Folder folder;
  fs::create_directories(folder.path());
  std::ofstream(folder / "f") << "\n\nno-value\nimage_shift not-a-number\n \nsync_issue true\n";
  const ParameterFile file = open(folder / "f");
  EXPECT_FALSE(file.last("image_shift", std::int64_t{0}));
  EXPECT_EQ(file.last("sync_issue", false), Value(true));
}

TEST(ParameterFile, SaysWhereItCannotWrite) {
  const auto file = ParameterFile::open("/proc/nowhere/f");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().find("/proc/nowhere/f"), std::string::npos);
}

TEST(CrashAtStart, HappensAsOftenAsItWasArmed) {
  const Folder folder;
  EXPECT_FALSE(take_crash(folder.path(), "camera"));
  ASSERT_TRUE(arm_crash(folder.path(), "camera", 2));
  EXPECT_FALSE(take_crash(folder.path(), "depth"));
  EXPECT_TRUE(take_crash(folder.path(), "camera"));
  EXPECT_TRUE(take_crash(folder.path(), "camera"));
  EXPECT_FALSE(take_crash(folder.path(), "camera"));
}

TEST(CrashAtStart, CanBeDisarmedAndNeedsAFolder) {
  const Folder folder;
  ASSERT_TRUE(arm_crash(folder.path(), "camera", 2));
  ASSERT_TRUE(arm_crash(folder.path(), "camera", 0));
  EXPECT_FALSE(take_crash(folder.path(), "camera"));
  EXPECT_FALSE(arm_crash("", "camera", 1));
}

}  // namespace
}  // namespace culprit::sunset
