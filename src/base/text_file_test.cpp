// Files that people wrote are replaced whole or not at all.
#include "base/text_file.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

struct TextFile : testing::Test {
  TextFile() { std::ofstream(file) << "old"; }

  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }

  const test::TestFolder own;
  const fs::path folder = own.path();
  const fs::path file = folder / "my.rules";
};

// While it lives, files of this process may not grow beyond `bytes`: a disk that takes no more.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit tight = before_;
    tight.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &tight);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST_F(TextFile, IsReplacedWithItsPermissions) {
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(write_text(file, "new"));
  EXPECT_EQ(*read_text(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(files(), 1);
}

TEST_F(TextFile, ANewOneMayBeCalledByItsNameAlone) {
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  const auto written = write_text("new.rules", "new");
  fs::current_path(before);
  EXPECT_TRUE(written) << written.error();
  EXPECT_EQ(*read_text(folder / "new.rules"), "new");
}

TEST_F(TextFile, IsAsItWasIfTheDiskIsFull) {
  const auto written = [&] {
    const FullDisk disk(1000);
    return write_text(file, std::string(100'000, 'x'));
  }();
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error(), HasSubstr("cannot write '" + file.string() + "': "));
  EXPECT_EQ(*read_text(file), "old");
  EXPECT_EQ(files(), 1) << "nothing is left beside it";
}

TEST_F(TextFile, ADeviceThatTakesNoMoreIsNamed) {
  const auto written = write_text("/dev/full", "text");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error(), HasSubstr("cannot write '/dev/full': No space left"));
}

TEST_F(TextFile, WhatCannotBeReadOrWrittenIsNamed) {
  EXPECT_THAT(read_text(folder / "none").error(), HasSubstr("No such file"));
  EXPECT_THAT(read_text(folder).error(), HasSubstr("is it a directory?"));
  EXPECT_THAT(write_text(folder / "none" / "my.rules", "").error(),
              HasSubstr("there is no folder"));
  EXPECT_THAT(write_text("/proc/culprit.rules", "").error(), HasSubstr("/proc/culprit.rules"));
}

}  // namespace
}  // namespace culprit
