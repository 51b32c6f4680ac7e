#include "language/formatter.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/parser.h"
#include "language/test_rules.h"
#include "language/test_tree.h"

namespace culprit {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::string formatted(const std::string& text) {
  const auto result = format(Source("test.rules", text));
  EXPECT_TRUE(result) << result.error() << text;
  return result ? *result : "";
}

// The tree that `text` stands for; what is wrong with it if there is none.
std::string tree_of(const std::string& text) {
  const Source source("test.rules", text);
  std::vector<Diagnostic> diagnostics;
  const std::string tree = tree_text(parse(source, diagnostics));
  return diagnostics.empty() ? tree : render(diagnostics.front(), source);
}

// Each golden/format_*.rules has its layout beside it. CULPRIT_WRITE_GOLDEN=1 writes the layout of
// now, for a person to read and commit.
TEST(Formatter, LaysOutAsTheGoldenFiles) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("src/core/language/golden")) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() != ".rules" || !path.filename().string().starts_with("format_")) continue;
    ++files;
    const auto expected = std::filesystem::path(path).replace_extension(".formatted");
    const std::string now = formatted(read(path));
    if (std::getenv("CULPRIT_WRITE_GOLDEN") != nullptr)
      std::ofstream(expected, std::ios::binary) << now;
    EXPECT_EQ(now, read(expected)) << path;
    EXPECT_EQ(formatted(now), now) << path;
    EXPECT_EQ(tree_of(now), tree_of(read(path))) << path;
  }
  EXPECT_GE(files, 2);
}

TEST(Formatter, FindsTheRulesOfTheProjectAsItLeavesThem) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator("rules")) {
    if (entry.path().extension() != ".rules") continue;
    ++files;
    EXPECT_EQ(formatted(read(entry.path())), read(entry.path()))
        << "lay it out with: culprit fmt " << entry.path().string();
  }
  EXPECT_GE(files, 2);
}

TEST(Formatter, LeavesNothingOfNothing) {
  EXPECT_EQ(formatted(""), "");
  EXPECT_EQ(formatted("\xEF\xBB\xBF \r\n\n\t\n"), "");
}

TEST(Formatter, RefusesWhatDoesNotParseAndSaysWhatACheckSays) {
  const auto result = format(Source("bad.rules", "RULE r\n  POLICIES EROR\nrule x\n"));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().find("bad.rules:2:12: error[R002]"), std::string::npos)
      << result.error();
  EXPECT_NE(result.error().find("bad.rules:3:1: error[R001]"), std::string::npos) << result.error();
}

TEST(Formatter, LaysOutRulesThatParseAndMakeNoSense) {
  EXPECT_EQ(formatted("RULE r\nTRIGGER 1+\"a\"\n"), "RULE r\n  TRIGGER 1 + \"a\"\n");
}

TEST(Formatter, DoesNotPadBeyondMeasure) {
  std::string text = "CONST a = \"" + std::string(100000, 'x') + "\"  # wide\n";
  for (int i = 0; i < 1000; ++i) text += "CONST b" + std::to_string(i) + " = 1  # narrow\n";
  EXPECT_LT(formatted(text).size(), text.size() + 1000 * 200);
}

// One kind of blank becomes another, so none may decide whether a line is a form to be filled in.
TEST(Formatter, TakesPlaceholdersForOnesWhateverTheirBlanks) {
  for (const std::string blank : {" ", "\t", "\f"}) {
    const std::string text = "SIGNAL s DIAGNOSTIC <a" + blank + "KEY" + blank + ">b\n";
    const auto result = format(Source("test.rules", text));
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().find("R008"), std::string::npos) << result.error();
  }
}

RC_GTEST_PROP(Formatter, KeepsWhatTheRulesSay, ()) {
  const RuleText rules = random_rule_text();
  const auto result = format(Source("test.rules", rules.text));
  if (!result) RC_FAIL(result.error() + rules.text);
  RC_ASSERT(tree_of(*result) == tree_of(rules.text));
}

RC_GTEST_PROP(Formatter, ChangesNothingTheSecondTime, ()) {
  const std::string once = formatted(random_rule_text().text);
  RC_ASSERT(formatted(once) == once);
}

RC_GTEST_PROP(Formatter, KeepsEveryCommentInItsOrder, ()) {
  const RuleText rules = random_rule_text();
  const std::string out = formatted(rules.text);
  std::size_t at = 0;
  for (const std::string& comment : rules.comments) {
    at = out.find(comment + "\n", at);
    RC_ASSERT(at != std::string::npos);
    at += comment.size();
  }
}

}  // namespace
}  // namespace culprit
