// The rule files that the project ships.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "language/scanner.h"

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

// The included files are beside them.
Expected<Source> load(const std::string& file, const std::string& from) {
  const auto path = (std::filesystem::path(from).parent_path() / file).lexically_normal();
  if (!std::filesystem::exists(path)) return Error{"there is no " + path.string()};
  return Source(path.string(), read_file(path));
}

TEST(RuleFiles, PassTheStrictCheckWithoutAWarning) {
  const auto files = rule_files("rules");
  EXPECT_GT(files.size(), 10u);
  for (const auto& file : files) {
    const Expansion rules = expand(Source(file.string(), read_file(file)), load);
    for (const Diagnostic& d : check(rules, Strictness::kStrict).diagnostics)
      ADD_FAILURE() << render(d, rules.source);
  }
}

// So every line of a pack is checked with arguments in it, and tried (rules/tests/packs/*.test).
TEST(RuleFiles, EveryTemplateOfAPackIsUsedByAnExample) {
  std::set<std::string> unused;
  for (const auto& file : rule_files("rules/packs")) {
    for (const auto& [name, known] : expand(Source(file.string(), read_file(file)), load).templates)
      unused.insert(name);
  }
  EXPECT_GT(unused.size(), 20u);
  for (const auto& file : rule_files("rules/tests/packs")) {
    const Source plain = expand(Source(file.string(), read_file(file)), load).source;
    for (std::uint32_t n = 1; n <= plain.line_count(); ++n) {
      std::string_view line = trimmed(plain.text(plain.line(n)));
      if (!line.starts_with('#')) continue;
      line = trimmed(line.substr(1));  // those within a template are indented
      if (!line.starts_with("USE ")) continue;
      const std::string_view use = line.substr(4);
      unused.erase(std::string(use.substr(0, use.find_first_of("( "))));
    }
  }
  EXPECT_EQ(unused, std::set<std::string>());
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
