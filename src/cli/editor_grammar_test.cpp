// The editor's grammar knows the same words as the language.
#include <fstream>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "base/text_file.h"
#include "json/json.h"
#include "language/functions.h"
#include "language/parser.h"
#include "language/reserved_words.h"
#include "language/syntax.h"

namespace culprit {
namespace {

using Words = std::set<std::string, std::less<>>;

Json read_json(const std::string& name) { return parse_json(*read_text("editors/vscode/" + name)); }

const Json& grammar() {
  static const Json document = read_json("syntaxes/culprit-rules.tmLanguage.json");
  return document;
}

// The alternatives of the pattern `name`, as in "\\b(true|false)\\b".
Words words_of(const std::string& name) {
  const std::string match = grammar().at("repository").at(name).at("match");
  std::smatch list;
  static const std::regex kList(R"(\(([A-Za-z_]+(\|[A-Za-z_]+)+)\))");
  if (!std::regex_search(match, list, kList)) return {};
  const std::string alternatives = list[1];
  static const std::regex kWord("[A-Za-z_]+");
  return Words(std::sregex_token_iterator(alternatives.begin(), alternatives.end(), kWord),
               std::sregex_token_iterator());
}

template <class Range>
Words set_of(const Range& range) {
  return Words(range.begin(), range.end());
}

TEST(EditorGrammar, KnowsEveryKeyword) {
  Words known = words_of("statements");
  known.merge(words_of("clauses"));
  // Words of the language that are also allowed as names: their place distinguishes them.
  for (const char* word : {"INCLUDE", "TEMPLATE", "END", "USE", "REPORT", "FROM", "THEN"})
    EXPECT_EQ(known.erase(word), 1u) << word;
  EXPECT_EQ(known, set_of(reserved_words()));
}

TEST(EditorGrammar, KnowsEveryAdaptation) {
  EXPECT_EQ(words_of("adaptations"), set_of(syntax::adaptation_keywords()));
}

TEST(EditorGrammar, KnowsEveryFunction) {
  EXPECT_EQ(words_of("functions"), set_of(function_names()));
}

TEST(EditorGrammar, KnowsEveryCriticality) {
  EXPECT_EQ(words_of("criticalities"),
            (Words{"NON_CRITICAL", "WARNING", "ERROR", "OK", "DEGRADED", "FAILURE"}));
}

TEST(EditorGrammar, IncludesOnlyWhatItDefines) {
  for (const auto& pattern : grammar().at("patterns")) {
    const std::string include = pattern.at("include");
    EXPECT_TRUE(grammar().at("repository").contains(include.substr(1))) << include;
  }
}

TEST(EditorGrammar, IsTheOneThatTheExtensionNames) {
  const auto contributes = read_json("package.json").at("contributes");
  const auto& entry = contributes.at("grammars").at(0);
  EXPECT_EQ(entry.at("scopeName"), grammar().at("scopeName"));
  EXPECT_EQ(entry.at("language"), contributes.at("languages").at(0).at("id"));
  EXPECT_EQ(entry.at("path"), "./syntaxes/culprit-rules.tmLanguage.json");
  EXPECT_EQ(read_json("language-configuration.json").at("comments").at("lineComment"), "#");
}

// A picture in PNG begins with a header of its width and height (w3.org/TR/png, 11.2.1); the marketplace wants 128 pixels.
TEST(EditorExtension, HasAnIcon) {
  std::ifstream file("editors/vscode/" + read_json("package.json").at("icon").get<std::string>(),
                     std::ios::binary);
  std::string bytes(24, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  EXPECT_EQ(bytes.substr(0, 16), std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16));
  EXPECT_EQ(bytes.substr(16), std::string("\0\0\0\x80\0\0\0\x80", 8));
}

TEST(EditorExtension, OffersOnlyCommandsThatItHas) {
  std::ifstream file("editors/vscode/src/extension.ts");
  const std::string source(std::istreambuf_iterator<char>(file), {});
  const Json contributes = read_json("package.json").at("contributes");
  Words commands;
  for (const auto& each : contributes.at("commands")) {
    commands.insert(each.at("command").get<std::string>());
    EXPECT_NE(source.find("registerCommand(\"" + each.at("command").get<std::string>() + "\""),
              std::string::npos)
        << each;
  }
  for (const auto& [menu, entries] : contributes.at("menus").items()) {
    for (const auto& each : entries)
      EXPECT_TRUE(commands.contains(each.at("command").get<std::string>())) << menu;
  }
}

// A snippet as it stands in the file when nothing is typed into it.
std::string as_inserted(const Json& snippet) {
  std::string text;
  for (const auto& line : snippet.at("body")) text += line.get<std::string>() + "\n";
  text = std::regex_replace(text, std::regex(R"(\$\{\d+:([^}]*)\})"), "$1");
  text = std::regex_replace(text, std::regex(R"(\$\{\d+\|([^,|]*)[^}]*\})"), "$1");
  return std::regex_replace(text, std::regex(R"(\$0)"), "");
}

TEST(EditorSnippets, AreWellFormed) {
  const Json snippets = read_json("snippets/culprit-rules.json");
  EXPECT_GT(snippets.size(), 5u);
  for (const auto& [name, snippet] : snippets.items()) {
    std::string text = as_inserted(snippet);
    if (text.starts_with("    ")) text = "RULE R\n  POLICIES ERROR\n  TRIGGER 1 > 0\n" + text;
    std::vector<Diagnostic> said;
    parse(Source(name, text), said);
    EXPECT_TRUE(said.empty()) << name << ": " << said.front().cause << "\n" << text;
  }
}

}  // namespace
}  // namespace culprit
