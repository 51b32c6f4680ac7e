#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"

namespace culprit::cli {
namespace {

struct ImportCommand : testing::Test {
  std::string path(const std::string& name) const { return (folder / name).string(); }

  // Its exit code.
  static int run(const std::vector<std::string>& arguments) {
    CLI::App app;
    int exit_code = -1;
    add_import(app, exit_code);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(std::move(reversed));
    return exit_code;
  }

  const test::TestFolder own;
  const std::filesystem::path folder = own.path();
};

TEST_F(ImportCommand, WritesTheRulesAndSumsUpTheNotes) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"import", "src/tools/import/golden/conditions.txt", "-o", path("out.rules")}),
            kOk);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::AllOf(testing::HasSubstr("7 rules imported, 1 kept as comments, 2"),
                             testing::HasSubstr("mission_phase is looked up on the robot: as the "
                                                "key of a diagnostic, or <hardware id>_<key> "
                                                "(6 places)\n"),
                             testing::HasSubstr("conditions.txt:36: note: this rule is kept as a "
                                                "comment: this trigger is never true")));
  std::ifstream in(path("out.rules"));
  const std::string text(std::istreambuf_iterator<char>(in), {});
  EXPECT_THAT(text, testing::HasSubstr("RULE dock_mode\n"));
}

TEST_F(ImportCommand, PrintsTheRulesWithoutAnOutputFile) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"import", "src/tools/import/golden/strategies.txt"}), kOk);
  testing::internal::GetCapturedStderr();
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("RULE ScanLost\n"));
}

TEST_F(ImportCommand, ShowsNoTextThatSteersATerminal) {
  std::ofstream(path("bad.txt")) << "BEGIN CONSTS\n  double x \x1b[2J\n";
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"import", path("bad.txt")}), kFailed);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("bad.txt:2:12: '\\x1b[2J' is no number"));
}

TEST_F(ImportCommand, ShowsNoNameOfAMemberThatSteersATerminal) {
  std::ofstream(path("bad.json")) << R"({"version": 1, "statements": [], "a\u001b[2J": 1})";
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"import", path("bad.json")}), kFailed);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("/a\\x1b[2J: there is no such member"));
}

TEST_F(ImportCommand, FailsWithAReason) {
  std::ofstream(path("bad.txt")) << "BEGIN CONSTS\n  double x ten\n";
  testing::internal::CaptureStderr();
  EXPECT_EQ(run({"import", path("bad.txt")}), kFailed);
  EXPECT_EQ(run({"import", path("missing.txt")}), kFailed);
  EXPECT_EQ(run({"import", "src/tools/import/golden/strategies.txt", "-o", path("no/such")}),
            kFailed);
  EXPECT_THAT(
      testing::internal::GetCapturedStderr(),
      testing::AllOf(testing::HasSubstr("bad.txt:2:12: 'ten' is no number"),
                     testing::HasSubstr("cannot read"), testing::HasSubstr("cannot write")));
}

}  // namespace
}  // namespace culprit::cli
