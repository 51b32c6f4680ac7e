#include "owners/start_of.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/spawn.h"
#include "owners/test_process.h"

namespace culprit::owners {
namespace {

TEST(StartOf, IsWhatItTakesToStartItAgain) {
  const test::TestFolder folder;
  Program program;
  program.arguments = {"sleep", "60"};
  program.environment = {"ROS_DOMAIN_ID=42"};
  program.folder = folder.path();
  program.log = folder.path() / "log";
  const auto pid = spawn(program);
  ASSERT_TRUE(pid) << pid.error();
  const auto started = start_of(*pid);
  end(*pid);
  ASSERT_TRUE(started);
  ASSERT_EQ(started->command.size(), 2u);
  EXPECT_TRUE(std::filesystem::path(started->command[0]).is_absolute()) << started->command[0];
  EXPECT_EQ(started->command[1], "60");
  EXPECT_EQ(started->folder, folder.path());
  EXPECT_THAT(started->environment, testing::Contains("ROS_DOMAIN_ID=42"));
}

// The interpreter of a virtual environment is a link, and finds its packages by the path of the link.
TEST(StartOf, NamesTheLinkByWhichAProgramWasStarted) {
  const test::TestFolder folder;
  const std::filesystem::path link = folder.path() / "bin" / "python3";
  std::filesystem::create_directory(link.parent_path());
  std::filesystem::create_symlink("/bin/sleep", link);
  for (const char* name : {"python3", "bin/python3"}) {
    Program program;
    program.arguments = {name, "60"};
    program.environment = {"PATH=relative:" + link.parent_path().native() + ":/usr/bin"};
    program.folder = folder.path();
    program.log = folder.path() / "log";
    const auto pid = spawn(program);
    ASSERT_TRUE(pid) << pid.error();
    const auto started = start_of(*pid);
    end(*pid);
    ASSERT_TRUE(started);
    EXPECT_EQ(started->command[0], link) << name;
  }
}

TEST(StartOf, AProgramThatIsGoneCannotBeStartedAgain) {
  const test::TestFolder folder;
  const std::filesystem::path copy = folder.path() / "node";
  std::filesystem::copy_file("/bin/sleep", copy);
  Program program;
  program.arguments = {copy, "60"};
  program.log = folder.path() / "log";
  const auto pid = spawn(program);
  ASSERT_TRUE(pid) << pid.error();
  std::filesystem::remove(copy);
  const auto started = start_of(*pid);
  end(*pid);
  EXPECT_FALSE(started);
}

TEST(StartOf, NothingWithoutAProcess) { EXPECT_FALSE(start_of(0)); }

}  // namespace
}  // namespace culprit::owners
