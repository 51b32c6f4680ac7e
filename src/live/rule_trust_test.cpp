#include "live/rule_trust.h"

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::live {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct RuleTrust : testing::Test {
  RuleTrust() {
    std::ofstream(file) << "COMPONENT c NODE /c\n";
    allow(file, 0644);
  }

  static void allow(const fs::path& path, int mode) {
    fs::permissions(path, static_cast<fs::perms>(mode));
  }
  // Empty: it is trusted.
  std::string objection() const {
    const auto trusted = trust_rules(file);
    return trusted ? "" : trusted.error();
  }
  std::string objection_to_state() const {
    const auto trusted = trust_state(folder / "state", folder / "state/my.journal");
    return trusted ? "" : trusted.error();
  }

  const test::TestFolder own;
  const fs::path folder = own.path();
  const fs::path file = folder / "my.rules";
};

TEST_F(RuleTrust, AFileThatOnlyItsOwnerWritesIsGood) { EXPECT_EQ(objection(), ""); }

TEST_F(RuleTrust, AFileThatOthersMayWriteIsNot) {
  allow(file, 0666);
  EXPECT_EQ(objection(),
            file.string() +
                " decides what is done to the robot, and another user could change it: " +
                file.string() + " is writable by others; chmod go-w " + file.string());
}

TEST_F(RuleTrust, NorOneThatOthersMayReplace) {
  allow(folder, 0777);
  EXPECT_THAT(objection(), HasSubstr(folder.string() + " is writable by others"));
  allow(folder, 01777);
  EXPECT_EQ(objection(), "") << "as in /tmp";
}

TEST_F(RuleTrust, NorASetupThatOthersMayWriteOrThatIsNotThere) {
  EXPECT_TRUE(trust_setup(file));
  allow(file, 0666);
  EXPECT_THAT(trust_setup(file).error(), HasSubstr("is run before a LAUNCH, and another user "));
  EXPECT_THAT(trust_setup(folder / "none").error(), HasSubstr("SETUP: cannot find"));
}

TEST_F(RuleTrust, NorOneOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  ASSERT_EQ(chown(file.c_str(), 12345, 12345), 0);
  EXPECT_THAT(objection(), HasSubstr("belongs to user 12345"));
}

TEST_F(RuleTrust, AGroupThatIsNotItsOwnersAloneCounts) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  ASSERT_EQ(chown(file.c_str(), 0, 12345), 0);
  allow(file, 0664);
  EXPECT_THAT(objection(), HasSubstr("is writable by others"));
}

TEST_F(RuleTrust, ALinkIsAsGoodAsWhatItLeadsTo) {
  const fs::path target = folder / "target.rules";
  fs::rename(file, target);
  fs::create_symlink(target, file);
  EXPECT_EQ(objection(), "");
  allow(target, 0666);
  EXPECT_THAT(objection(), HasSubstr(target.string() + " is writable by others"));
}

TEST_F(RuleTrust, StateThatOthersMayWriteIsNotTaken) {
  EXPECT_EQ(objection_to_state(), "") << "it will be made where only we write";
  fs::create_directories(folder / "state/log");
  std::ofstream(folder / "state/my.journal") << "";
  std::ofstream(folder / "state/my.journal-lock") << "";
  for (const auto& each : fs::recursive_directory_iterator(folder / "state"))
    allow(each.path(), each.is_directory() ? 0755 : 0644);
  allow(folder / "state", 0755);
  EXPECT_EQ(objection_to_state(), "");
  for (const char* each : {"state", "state/log", "state/my.journal", "state/my.journal-lock"}) {
    const auto before = fs::status(folder / each).permissions();
    allow(folder / each, 0777);
    EXPECT_THAT(objection_to_state(),
                HasSubstr((folder / each).string() + " is writable by others; chmod go-w"));
    fs::permissions(folder / each, before);
  }
  EXPECT_EQ(objection_to_state(), "");
}

TEST_F(RuleTrust, TheJournalIsMadePrivate) {
  for (const char* each : {"my.journal", "my.journal-wal", "yours.journal"}) {
    std::ofstream(folder / each) << "";
    allow(folder / each, 0644);
  }
  fs::create_symlink("yours.journal", folder / "my.journal-link");
  make_private(folder / "my.journal");
  const auto mode = [&](const char* name) {
    return static_cast<int>(fs::status(folder / name).permissions());
  };
  EXPECT_EQ(mode("my.journal"), 0600);
  EXPECT_EQ(mode("my.journal-wal"), 0600);
  EXPECT_EQ(mode("yours.journal"), 0644) << "no link is followed";
}

TEST_F(RuleTrust, NorStateThatOthersMayMake) {
  allow(folder, 0777);
  EXPECT_THAT(objection_to_state(), HasSubstr(folder.string() + " is writable by others"));
}

TEST_F(RuleTrust, NorStateOfAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give files away";
  fs::create_directory(folder / "state");
  ASSERT_EQ(chown((folder / "state").c_str(), 12345, 12345), 0);
  EXPECT_THAT(objection_to_state(), HasSubstr("belongs to user 12345"));
}

}  // namespace
}  // namespace culprit::live
