// docs/grammar.ebnf says what the parser does.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/parser.h"
#include "language/test_ebnf.h"
#include "language/test_rules.h"

namespace culprit {
namespace {

std::string text_without_mark(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const Source source(path.string(), std::string(std::istreambuf_iterator<char>(in), {}));
  return std::string(source.text());  // without a byte order mark
}

template <bool (*is_one)(char)>
std::optional<std::size_t> one(const std::string& text, std::size_t at) {
  return at < text.size() && is_one(text[at]) ? std::optional<std::size_t>(1) : std::nullopt;
}
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_in_line(char c) { return c != '\n'; }
bool is_in_name(char c) {
  const bool is_control = static_cast<unsigned char>(c) <= ' ' || c == 0x7f;
  return !is_control && std::string_view(",()#/\"").find(c) == std::string_view::npos;
}
bool is_in_text(char c) { return c != '\n' && c != '"' && c != '\\'; }

// Whether a TEMPLATE is open there.
bool is_in_template(const std::string& text, std::size_t at) {
  bool is_open = false;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos && end < at;
       begin = end + 1, end = text.find('\n', begin)) {
    const std::string_view line = trimmed(std::string_view(text).substr(begin, end - begin));
    if (line.starts_with("TEMPLATE")) is_open = true;
    if (line.starts_with("END")) is_open = false;
  }
  return is_open;
}

std::optional<std::size_t> hole(const std::string& text, std::size_t at) {
  const std::size_t length = hole_length(std::string_view(text).substr(at));
  return length > 0 && is_in_template(text, at) ? std::optional(length) : std::nullopt;
}

std::optional<std::size_t> line_break(const std::string& text, std::size_t at) {
  if (at == text.size()) return 0;
  if (text[at] == '\n') return 1;
  return text.compare(at, 2, "\r\n") == 0 ? std::optional<std::size_t>(2) : std::nullopt;
}

const Grammar& grammar() {
  static const Grammar all(
      text_without_mark("docs/grammar.ebnf"),
      {{"A to Z, a to z, _", {{"a", "Z", "_", "e", "s"}, one<is_letter>}},
       {"0 to 9", {{"0", "1", "9"}, one<is_digit>}},
       {"any character but LF", {{"x", " ", "#", "\"", "ü", "<", ">", "/"}, one<is_in_line>}},
       {"{ Letter, then letters and digits, then }; in a template only", {{}, hole}},
       {"LF, CR LF, or the end of the file", {{"\n", "\r\n"}, line_break}},
       {"any character but blanks, LF, control characters and , ( ) # / double quotes",
        {{"a", "0", ".", "[", "-", "~", "=", "é"}, one<is_in_name>}},
       {"any character but LF, double quotes and \\",
        {{"a", " ", "#", "/", "(", ",", "ß"}, one<is_in_text>}}});
  return all;
}

// The mistake that the parser finds in the form of `text`; empty: none.
std::string complaint(const std::string& text) {
  const Source source("sentence.rules", text);
  std::vector<Diagnostic> diagnostics;
  parse(source, diagnostics);
  for (const Diagnostic& d : diagnostics) {
    // The grammar allows a clause twice on a line; the parser does not.
    const bool is_repeated = d.cause.ends_with(" is given twice");
    if (d.code < Code::kDuplicateName && !is_repeated) return render(d, source) + "in:\n" + text;
  }
  return "";
}

// All but the one that says what no sentence holds.
Grammar::Productions productions_of_sentences() {
  Grammar::Productions all = grammar().productions();
  all.erase("ReservedWord");
  return all;
}

// Productions that only templates hold; generated sentences have no parameters.
bool is_holed(const std::string& production) { return production.starts_with("Hole"); }

TEST(Grammar, MakesSentencesThatTheParserTakes) {
  constexpr int kSentences = 800;
  std::mt19937 random(1);
  std::map<std::string, int> count;
  for (int n = 0; n < kSentences; ++n) {
    Grammar::Productions used;
    const std::string text = grammar().sentence("file", 8 + n % 20, random, used);
    ASSERT_EQ(complaint(text), "");
    for (const std::string& production : used) ++count[production];
  }
  // A file hardly has these.
  for (int n = 0; n < kSentences / 8; ++n) {
    Grammar::Productions used;
    const std::string text = grammar().sentence("reuse", 8 + n % 20, random, used);
    ASSERT_EQ(complaint(text), "");
    for (const std::string& production : used) ++count[production];
  }
  for (const std::string& production : productions_of_sentences()) {
    if (is_holed(production)) continue;
    EXPECT_GE(count[production], kSentences / 200) << production << " was hardly tried";
  }
}

RC_GTEST_PROP(Grammar, KnowsEveryTextThatIsWellFormed, ()) {
  const std::string text = random_rule_text().text;
  RC_ASSERT(complaint(text) == "");
  if (!grammar().derive("file", text)) RC_FAIL("the grammar does not know:\n" + text);
}

// So no production is there for nothing, and each is seen by the tests of what comes after parsing.
TEST(Grammar, HasNoProductionThatNoRuleFileUses) {
  Grammar::Productions unused = productions_of_sentences();
  for (const char* folder : {"rules", "src/core/language/golden"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".rules") continue;
      const std::string text = text_without_mark(entry.path());
      std::vector<Diagnostic> diagnostics;
      parse(Source("", text), diagnostics);
      if (!diagnostics.empty()) continue;  // golden files hold mistakes, too
      const auto used = grammar().derive("file", text);
      ASSERT_TRUE(used) << entry.path() << " parses, and the grammar does not know it";
      for (const std::string& production : *used) unused.erase(production);
    }
  }
  EXPECT_EQ(unused, Grammar::Productions());
}

TEST(Grammar, ReservesTheWordsThatTheParserReserves) {
  std::mt19937 random(1);
  std::set<std::string> words;
  for (int n = 0; n < 1000; ++n) {
    Grammar::Productions used;
    words.insert(grammar().sentence("ReservedWord", 1, random, used));
  }
  EXPECT_EQ(words.size(), 51u);
  for (const std::string& word : words) {
    std::vector<Diagnostic> diagnostics;
    parse(Source("", "CONST " + word + " = 1\n"), diagnostics);
    ASSERT_EQ(diagnostics.size(), 1u) << word;
    EXPECT_EQ(diagnostics[0].code, Code::kReservedWord) << word;
  }
}

TEST(Grammar, RefusesWhatTheParserRefuses) {
  const std::string rule = "RULE r\nPOLICIES ERROR\nTRIGGER ";
  const std::string rest = "\nSTRATEGY s 1 1\nADAPTATION c restart 1\n";
  EXPECT_TRUE(grammar().derive("file", rule + "a ? b : c" + rest));
  for (const char* trigger : {"", "a +", "a b", "(a", "a)", "a ? b", "rate()", "rat(/t)", "\"a",
                              "5 x", "a = b", "mean(a)", "! && a", "a and b"}) {
    const std::string text = rule + trigger + rest;
    EXPECT_FALSE(grammar().derive("file", text)) << trigger;
    std::vector<Diagnostic> diagnostics;
    parse(Source("", text), diagnostics);
    EXPECT_FALSE(diagnostics.empty()) << trigger;
  }
  for (const char* line : {"rule r", "CONST RULE = 1", "CYCLE 200", "COMPONENT c NODE c",
                           "SIGNAL s TOPIC /t", "ROBOT a b", "IGNORE TOPIC", "CONST a = \"\\x\""}) {
    EXPECT_FALSE(grammar().derive("file", line)) << line;
    std::vector<Diagnostic> diagnostics;
    parse(Source("", line), diagnostics);
    EXPECT_FALSE(diagnostics.empty()) << line;
  }
}

}  // namespace
}  // namespace culprit
