#include "cli/rule_trust.h"

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kLaunches = "COMPONENT c LAUNCH \"c --on\"\n";

struct RuleTrust : testing::Test {
  RuleTrust() {
    std::string name = (fs::temp_directory_path() / "culprit-trust-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
    file = folder / "my.rules";
    std::ofstream(file) << kLaunches;
    allow(file, 0644);
  }
  ~RuleTrust() override { fs::remove_all(folder); }

  static void allow(const fs::path& path, int mode) {
    fs::permissions(path, static_cast<fs::perms>(mode));
  }
  // Empty: it is trusted.
  std::string objection(const char* rules = kLaunches) const {
    const auto trusted = trust_launches(*check(Source("my.rules", rules)).rules, file);
    return trusted ? "" : trusted.error();
  }

  fs::path folder;
  fs::path file;
};

TEST_F(RuleTrust, AFileThatOnlyItsOwnerWritesIsGood) { EXPECT_EQ(objection(), ""); }

TEST_F(RuleTrust, AFileThatOthersMayWriteIsNot) {
  allow(file, 0666);
  EXPECT_EQ(objection(),
            file.string() +
                " says which programs are started, and somebody else could change it: " +
                file.string() + " is writable by others; chmod go-w " + file.string());
  EXPECT_EQ(objection("COMPONENT c NODE /c\n"), "") << "nothing is started by it";
}

TEST_F(RuleTrust, NorOneThatOthersMayReplace) {
  allow(folder, 0777);
  EXPECT_THAT(objection(), HasSubstr(folder.string() + " is writable by others"));
  allow(folder, 01777);
  EXPECT_EQ(objection(), "") << "as in /tmp";
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

}  // namespace
}  // namespace culprit::cli
