// The one shell that culprit runs: its input, its output, and its errors.
#include "owners/setup.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct Setup : testing::Test {
  Expected<std::vector<std::string>> source(const std::string& text,
                                            const std::vector<std::string>& given = {},
                                            Duration limit = 30s) {
    std::filesystem::create_directories(folder);
    std::ofstream(file) << text;
    return environment_after(file, given, limit);
  }

  const test::TestFolder own;
  const std::filesystem::path folder = own / "a setup '$(x)";  // nothing that a shell would read
  const std::filesystem::path file = folder / "a \"setup\".bash";
};

TEST_F(Setup, GivesWhatTheFileSetsAndWhatWasThereBefore) {
  setenv("CULPRIT_INHERITED", "yes", 1);
  const auto after = source("export LINES_OF='one\ntwo'\nexport PATH=/opt/robot/bin:$PATH\n");
  unsetenv("CULPRIT_INHERITED");
  ASSERT_TRUE(after) << after.error();
  EXPECT_THAT(*after, AllOf(Contains("LINES_OF=one\ntwo"), Contains("CULPRIT_INHERITED=yes"),
                            Contains(StartsWith("PATH=/opt/robot/bin:"))));
  EXPECT_THAT(*after, Not(Contains(StartsWith("SHLVL="))));
}

TEST_F(Setup, WhatTheRulesSetIsSeenAndStays) {
  const auto after = source("export SEEN=$MAP\nexport MAP=other\n", {"MAP=the yard"});
  ASSERT_TRUE(after) << after.error();
  EXPECT_THAT(*after, AllOf(Contains("SEEN=the yard"), Contains("MAP=the yard"),
                            Not(Contains("MAP=other"))));
}

TEST_F(Setup, WhatTheFilePrintsIsNoEnvironment) {
  const auto after = source("echo INJECTED=1\nexport A=b\n");
  ASSERT_TRUE(after) << after.error();
  EXPECT_THAT(*after, AllOf(Contains("A=b"), Not(Contains("INJECTED=1"))));
}

TEST_F(Setup, TheFileSeesNoArgumentsAndNoOtherFileOfBash) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "other") << "export OTHER=1\n";
  const auto after = source("export COUNT=$#\n", {"BASH_ENV=" + (folder / "other").string()});
  ASSERT_TRUE(after) << after.error();
  EXPECT_THAT(*after, AllOf(Contains("COUNT=0"), Not(Contains("OTHER=1"))));
}

TEST_F(Setup, OneThatFailsIsToldWithWhatItSaidLast) {
  const auto failed = source("echo first >&2\necho no ROS here >&2\nfalse\n");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error(), "SETUP " + file.string() + " failed: no ROS here");
  EXPECT_THAT(source("exit 0\n").error(), HasSubstr("failed")) << "it gave nothing";
  const auto missing = environment_after(folder / "none.bash", {});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error(), HasSubstr("No such file or directory"));
}

TEST_F(Setup, OneThatHangsIsEndedWithWhatItStarted) {
  const auto hung = source("sleep 1000 &\necho $! > \"$PIDS\"\nsleep 1000\n",
                           {"PIDS=" + (folder / "pid").string()}, 1s);
  ASSERT_FALSE(hung);
  EXPECT_THAT(hung.error(), HasSubstr("took longer than 1s"));
  int pid = 0;
  std::ifstream(folder / "pid") >> pid;
  ASSERT_GT(pid, 1);
  for (int tries = 0; tries < 1000 && state_letter(pid).value_or('Z') != 'Z'; ++tries)
    std::this_thread::sleep_for(10ms);
  EXPECT_EQ(state_letter(pid).value_or('Z'), 'Z');
}

TEST_F(Setup, OneWithoutEndIsRefused) {
  const auto much = source(
      "export A=$(head -c 100000 /dev/zero | tr '\\0' a)\nexport B=$A C=$A D=$A "
      "E=$A F=$A G=$A H=$A I=$A J=$A K=$A L=$A M=$A\n");
  EXPECT_FALSE(much);
  EXPECT_FALSE(source("while :; do echo again; done\n", {}, 1s));
}

}  // namespace
}  // namespace culprit::owners
