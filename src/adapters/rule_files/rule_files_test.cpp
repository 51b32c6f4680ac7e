#include "rule_files/rule_files.h"

#include <fstream>
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::rule_files {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class RuleFiles : public testing::Test {
 protected:
  fs::path folder = fs::path(testing::TempDir()) / "rule_files_test";

  void SetUp() override { fs::remove_all(folder); }

  std::string write(const std::string& name, const std::string& text) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
};

TEST_F(RuleFiles, AreFoundBesideTheFileThatIncludesThem) {
  write("common/limits.rules", "INCLUDE \"deeper/a.rules\"\nCONST limit = a\n");
  write("common/deeper/a.rules", "CONST a = 1\n");
  write("deeper/a.rules", "CONST a = broken\n");
  const auto rules =
      read(write("robot.rules", "INCLUDE \"common/limits.rules\"\nCONST b = limit\n"));
  ASSERT_TRUE(rules) << rules.error();
  EXPECT_TRUE(check(*rules).rules);
  EXPECT_EQ(rules->source.file(2).name(), (folder / "common/deeper/a.rules").string());
}

TEST_F(RuleFiles, AreFoundAmongTheInstalledOnes) {
  const auto loaded = load("cookbook/battery_low.rules", write("robot.rules", ""));
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(loaded->name(), (installed() / "cookbook/battery_low.rules").string());
}

TEST_F(RuleFiles, BesideComesBeforeInstalled) {
  const std::string mine = write("cookbook/battery_low.rules", "# mine\n");
  EXPECT_EQ(load("cookbook/battery_low.rules", write("robot.rules", ""))->name(), mine);
}

TEST_F(RuleFiles, AreThereOnceHoweverTheyAreCalled) {
  write("a.rules", "INCLUDE \"sub/../b.rules\"\n");
  write("sub/c.rules", "INCLUDE \"../b.rules\"\n");
  write("b.rules", "CONST b = 1\n");
  const auto rules = read(write("robot.rules", "INCLUDE \"a.rules\"\nINCLUDE \"sub/c.rules\"\n"));
  EXPECT_TRUE(check(*rules).rules);
}

TEST_F(RuleFiles, SayWhereTheyWereLookedForAndWhatWasMeant) {
  write("packs/nav2.rules", "");
  const std::string robot = write("robot.rules", "");
  EXPECT_THAT(load("packs/nav3.rules", robot).error(),
              HasSubstr("did you mean 'packs/nav2.rules'?"));
  EXPECT_THAT(load("none/at_all.rules", robot).error(), HasSubstr(installed().string()));
}

TEST_F(RuleFiles, AreNothingElse) {
  const std::string robot = write("robot.rules", "");
  write("secret.txt", "hidden");
  EXPECT_THAT(load("secret.txt", robot).error(), HasSubstr("is called *.rules"));
  EXPECT_THAT(load("camera.yaml", robot).error(), HasSubstr("behind --params-file in its LAUNCH"));
  fs::create_directories(folder / "folder.rules");
  EXPECT_FALSE(load("folder.rules", robot));
  EXPECT_FALSE(load("/dev/zero", robot));
}

// Reading one could wait for ever, and give something else each time.
TEST_F(RuleFiles, ReadNoPipe) {
  write("robot.rules", "");
  const auto pipe = folder / "pipe.rules";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& each : {pipe.string(), std::string("/dev/zero")}) {
    const auto rules = read(each);
    ASSERT_FALSE(rules);
    EXPECT_THAT(rules.error(), HasSubstr("is a pipe, a socket or a device"));
  }
}

TEST_F(RuleFiles, OfAFolderAreThoseOfItsFoldersToo) {
  write("b.rules", "");
  write("a/c.rules", "");
  write("a/t.test", "");
  write(".git/d.rules", "");
  EXPECT_THAT(*files_in(folder.string(), ".rules"),
              ElementsAre((folder / "a/c.rules").string(), (folder / "b.rules").string()));
  EXPECT_THAT(*files_in("no/such.rules", ".rules"), ElementsAre("no/such.rules"));
  EXPECT_FALSE(files_in((folder / "a").string(), ".state"));
  EXPECT_THAT(includable((folder / "b.rules").string()), Contains("a/c.rules"));
}

}  // namespace
}  // namespace culprit::rule_files
