// The rule files that the project ships.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::vector<std::filesystem::path> rule_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".rules") files.push_back(entry.path());
  }
  return files;
}

TEST(RuleFiles, PassTheStrictCheckWithoutAWarning) {
  const auto files = rule_files("rules");
  EXPECT_GT(files.size(), 10u);
  for (const auto& file : files) {
    const Source source(file.string(), read_file(file));
    for (const Diagnostic& d : check(source, Strictness::kStrict).diagnostics)
      ADD_FAILURE() << render(d, source);
  }
}

TEST(RuleFiles, OfTheCookbookStandInItAsTheyAre) {
  const std::string book = read_file("docs/rules-cookbook.md");
  const auto files = rule_files("rules/cookbook");
  EXPECT_EQ(files.size(), 10u);
  for (const auto& file : files) {
    const std::string quoted = "`" + file.string() + "`:\n\n```\n" + read_file(file) + "```\n";
    EXPECT_NE(book.find(quoted), std::string::npos)
        << file << " and its text in docs/rules-cookbook.md differ";
  }
}

}  // namespace
}  // namespace culprit
