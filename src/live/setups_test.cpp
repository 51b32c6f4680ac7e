#include "live/setups.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "language/checker.h"

namespace culprit::live {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Clause = LiveInventory::LaunchTrouble::Clause;

struct Setups : testing::Test {
  Setups() {
    std::ofstream(setup) << "echo read >> " << folder << "/count\nexport PATH=" << folder
                         << ":$PATH\n";
    std::filesystem::permissions(setup, std::filesystem::perms(0600));
  }

  static RuleSet rules(const std::string& components) {
    return *check(Source("test.rules", components)).rules;
  }
  // For a component with these clauses.
  static std::optional<LiveInventory::LaunchTrouble> trouble(const std::string& clauses) {
    const auto all = launch_troubles(rules("COMPONENT c " + clauses + "\n"));
    return all.empty() ? std::nullopt : std::optional(all.front());
  }
  void add_program(const char* name) const {
    std::filesystem::create_symlink("/bin/sleep", folder / name);
  }

  const test::TestFolder own;
  const std::filesystem::path& folder = own.path();
  const std::filesystem::path setup = folder / "setup.bash";
};

TEST_F(Setups, AreReadOnceForAllThatHaveTheSame) {
  const std::string same = " LAUNCH \"a\" SETUP " + setup.string();
  const RuleSet set = rules("COMPONENT a" + same + "\nCOMPONENT b" + same + "\nCOMPONENT c\n");
  const auto environments = environments_of(set);
  ASSERT_EQ(environments.size(), 3u);
  ASSERT_TRUE(environments[1]) << environments[1].error();
  EXPECT_THAT(*environments[1], Contains(HasSubstr("PATH=" + folder.string())));
  EXPECT_TRUE(environments[2]->empty());
  std::ifstream count(folder / "count");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(count), {}), "read\n");
}

TEST_F(Setups, AProgramIsLookedForWhereTheRulesSay) {
  add_program("only_there");
  EXPECT_FALSE(trouble("LAUNCH \"only_there 1\" ENV \"PATH=" + folder.string() + "\""));
  const auto found = trouble("LAUNCH \"only_there 1\"");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->clause, Clause::kLaunch);
  EXPECT_EQ(found->why, "there is no program 'only_there' in PATH");
}

TEST_F(Setups, AProgramIsLookedForOnceAndMissedByAllThatNeedIt) {
  add_program("only_there");
  const std::string there = " ENV \"PATH=" + folder.string() + "\"\n";
  const auto found = launch_troubles(
      rules("COMPONENT a LAUNCH \"only_there 1\"\nCOMPONENT b LAUNCH \"only_there 2\"" + there +
            "COMPONENT c LAUNCH \"only_there 3\"\nCOMPONENT d LAUNCH \"other\"\nCOMPONENT e\n"));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].component, "a");
  EXPECT_EQ(found[1].component, "c");
  EXPECT_EQ(found[1].why, found[0].why);
  EXPECT_EQ(found[2].component, "d");
  EXPECT_THAT(found[2].why, HasSubstr("'other'"));
}

// culprit's own folder, which is hardly in PATH.
TEST_F(Setups, AProgramIsLookedForBesideCulpritToo) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").filename();
  EXPECT_FALSE(trouble("LAUNCH \"" + self + " 1\""));
}

// A checked rule file may be another user's.
TEST_F(Setups, NothingIsRunToCheckThem) {
  EXPECT_FALSE(trouble("LAUNCH \"only_there 1\" SETUP " + setup.string()));
  EXPECT_FALSE(std::filesystem::exists(folder / "count"));
}

TEST_F(Setups, WhatIsMissingIsNamed) {
  const auto no_file = trouble("LAUNCH \"sleep 1\" SETUP /does/not/exist.bash");
  ASSERT_TRUE(no_file);
  EXPECT_EQ(no_file->clause, Clause::kSetup);
  EXPECT_THAT(no_file->why, HasSubstr("cannot find /does/not/exist.bash"));
  const auto no_folder = trouble("LAUNCH \"sleep 1\" CWD /does/not/exist");
  ASSERT_TRUE(no_folder);
  EXPECT_EQ(no_folder->clause, Clause::kFolder);
  EXPECT_FALSE(trouble("UNIT c.service")) << "systemd starts it";
}

TEST_F(Setups, OneThatOthersMayWriteIsNotRead) {
  std::filesystem::permissions(setup, std::filesystem::perms(0666));
  const std::string clauses = "LAUNCH \"sleep 1\" SETUP " + setup.string();
  const auto found = trouble(clauses);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->why, HasSubstr("another user could change it"));
  EXPECT_FALSE(environments_of(rules("COMPONENT c " + clauses + "\n"))[0]);
  EXPECT_FALSE(std::filesystem::exists(folder / "count"));
}

}  // namespace
}  // namespace culprit::live
