// culprit fmt as a user runs it: files, output and exit codes.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <sys/stat.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"
#include "cli/test_command.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

constexpr const char* kCareless = "CONST a=1\r\n\n\nRULE r\nTRIGGER  a>2\n";
constexpr const char* kCanonical = "CONST a = 1\n\nRULE r\n  TRIGGER a > 2\n";

struct Fmt : testing::Test {
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return (folder / name).string();
  }
  static std::string read(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }

  // Gives the exit code; what was printed is in `out` and `err`.
  int fmt(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "fmt");
    CommandEnd end = end_of_command(add_fmt, std::move(arguments));
    out = std::move(end.out);
    err = std::move(end.err);
    return end.exit_code;
  }

  const test::TestFolder own;
  const std::filesystem::path folder = own.path();
  std::string out;
  std::string err;
};

TEST_F(Fmt, SaysOnceThatAFileIsNoRuleFile) {
  EXPECT_EQ(fmt({write("notes.txt", "Buy milk.\nCall the lab.\n")}), kFailed);
  EXPECT_THAT(err, HasSubstr("no line of this file is a statement of the rule language"));
  EXPECT_EQ(err.find("error["), err.rfind("error[")) << err;
}

TEST_F(Fmt, RewritesAFileAndKeepsItsPermissions) {
  const std::string file = write("a.rules", kCareless);
  chmod(file.c_str(), 0640);
  EXPECT_EQ(fmt({file}), kOk);
  EXPECT_EQ(read(file), kCanonical);
  EXPECT_THAT(out, HasSubstr("a.rules: formatted"));
  struct stat now {};
  stat(file.c_str(), &now);
  EXPECT_EQ(now.st_mode & 07777, 0640u);
  const auto left = std::distance(std::filesystem::directory_iterator(folder), {});
  EXPECT_EQ(left, 1) << "a temporary file was left behind";
}

TEST_F(Fmt, DoesNotTouchAFileThatIsAsItShouldBe) {
  const std::string file = write("a.rules", kCanonical);
  struct stat before {};
  stat(file.c_str(), &before);
  EXPECT_EQ(fmt({file}), kOk);
  struct stat now {};
  stat(file.c_str(), &now);
  EXPECT_EQ(now.st_ino, before.st_ino);
  EXPECT_EQ(out, "");
}

TEST_F(Fmt, FollowsSymbolicLinks) {
  const std::string file = write("a.rules", kCareless);
  const std::string link = (folder / "link.rules").string();
  std::filesystem::create_symlink(file, link);
  EXPECT_EQ(fmt({link}), kOk);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read(file), kCanonical);
}

TEST_F(Fmt, CheckListsWhatWouldChangeAndWritesNothing) {
  const std::string careless = write("a.rules", kCareless);
  const std::string canonical = write("b.rules", kCanonical);
  EXPECT_EQ(fmt({"--check", careless, canonical}), kFailed);
  EXPECT_EQ(out, careless + "\n");
  EXPECT_EQ(read(careless), kCareless);
  EXPECT_EQ(fmt({"--check", canonical}), kOk);
  EXPECT_EQ(out, "");
}

TEST_F(Fmt, DiffShowsWhatWouldChangeAndWritesNothing) {
  const std::string file = write("a.rules", kCareless);
  EXPECT_EQ(fmt({"--diff", file}), kOk);
  EXPECT_EQ(out, "--- " + file + "\n+++ " + file +
                     "\n@@ -1,5 +1,4 @@\n"
                     "-CONST a=1\r\n"
                     "+CONST a = 1\n"
                     " \n"
                     "-\n"
                     " RULE r\n"
                     "-TRIGGER  a>2\n"
                     "+  TRIGGER a > 2\n");
  EXPECT_EQ(read(file), kCareless);
  EXPECT_EQ(fmt({"--diff", "--check", file}), kFailed);
}

TEST_F(Fmt, LeavesAFileWithErrorsAndFormatsTheOthers) {
  const std::string broken = write("a.rules", "RULE r\nPOLICIES  EROR\n");
  const std::string careless = write("b.rules", kCareless);
  EXPECT_EQ(fmt({broken, careless, (folder / "none.rules").string()}), kFailed);
  EXPECT_EQ(read(broken), "RULE r\nPOLICIES  EROR\n");
  EXPECT_EQ(read(careless), kCanonical);
  EXPECT_THAT(err, HasSubstr("a.rules:2:11: error[R002]"));
  EXPECT_THAT(err, HasSubstr("none.rules"));
}

TEST_F(Fmt, SaysThatAFolderHasNoRules) {
  EXPECT_EQ(fmt({folder.string()}), kFailed);
  EXPECT_THAT(err, HasSubstr("there is no *.rules in "));
}

TEST_F(Fmt, ReadsTheStandardInput) {
  std::istringstream in(kCareless);
  std::streambuf* before = std::cin.rdbuf(in.rdbuf());
  EXPECT_EQ(fmt({"-"}), kOk);
  std::cin.rdbuf(before);
  EXPECT_EQ(out, kCanonical);
}

}  // namespace
}  // namespace culprit::cli
