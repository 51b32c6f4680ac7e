// culprit export and the way back, as a user runs them.
#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "cli/commands.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

struct ExportCommand : testing::Test {
  std::string path(const std::string& name) const { return (folder / name).string(); }
  static std::string read(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }

  // Gives the exit code; what was said is in `said`.
  int run(std::vector<std::string> arguments) {
    CLI::App app;
    int exit_code = -1;
    add_export(app, exit_code);
    add_import(app, exit_code);
    std::reverse(arguments.begin(), arguments.end());
    testing::internal::CaptureStderr();
    app.parse(std::move(arguments));
    said = testing::internal::GetCapturedStderr();
    return exit_code;
  }

  const test::TestFolder own;
  const std::filesystem::path folder = own.path();
  std::string said;
};

TEST_F(ExportCommand, WritesJsonThatIsImportedByteForByte) {
  ASSERT_EQ(run({"export", "--json", "rules/sunset.rules", "-o", path("rules.json")}), kOk) << said;
  EXPECT_THAT(read(path("rules.json")), HasSubstr("\"statement\": \"RULE\""));
  ASSERT_EQ(run({"import", path("rules.json"), "-o", path("back.rules")}), kOk) << said;
  EXPECT_EQ(read(path("back.rules")), read("rules/sunset.rules"));
  EXPECT_EQ(said, "");
}

TEST_F(ExportCommand, FailsWithAReason) {
  std::ofstream(path("bad.rules")) << "RULE\n";
  EXPECT_EQ(run({"export", "--json", path("bad.rules")}), kFailed);
  EXPECT_THAT(said, HasSubstr("bad.rules:1:5: error[R002]"));
  EXPECT_EQ(run({"export", "--json", path("missing.rules")}), kFailed);
  EXPECT_THAT(said, HasSubstr("cannot read"));
  EXPECT_EQ(run({"export", "--json", "rules/sunset.rules", "-o", path("no/such")}), kFailed);
  EXPECT_THAT(said, HasSubstr("cannot write"));

  std::ofstream(path("bad.json")) << R"({"version": 1, "statements": [{"statement": "RULE"}]})";
  EXPECT_EQ(run({"import", path("bad.json"), "-o", path("out.rules")}), kFailed);
  EXPECT_THAT(said, HasSubstr("bad.json: /statements/0/name: this member is missing"));
  EXPECT_FALSE(std::filesystem::exists(path("out.rules")));
}

}  // namespace
}  // namespace culprit::cli
