#include "rule_test/reader.h"

#include <algorithm>
#include <array>
#include <unordered_set>
#include <utility>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "rule_test/answer_reader.h"
#include "rule_test/expectation_reader.h"
#include "rule_test/names.h"
#include "rule_test/setup_reader.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

class Reader {
 public:
  Reader(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics)
      : source_(source),
        rules_(rules),
        read_(source, diagnostics),
        names_(rules, diagnostics),
        setup_(source, rules, read_, names_),
        diagnostics_(diagnostics) {}

  Suite read() {
    for (std::uint32_t line = 1; line <= source_.line_count(); ++line) {
      Scanner scanner(source_.text(), source_.line(line));
      if (!scanner.at_end()) statement(scanner);
    }
    end_test();
    if (suite_.tests.empty() && diagnostics_.empty())
      read_.fail(Code::kIncomplete, {}, "this file has no test", "begin one with TEST \"name\"");
    return std::move(suite_);
  }

 private:
  struct Statement {
    std::string_view keyword;
    bool (Reader::*read)(Scanner&);
  };
  static constexpr std::size_t kStatementCount = 7;
  static const std::array<Statement, kStatementCount> kStatements;

  void statement(Scanner& s) {
    const Token head = s.next();
    if (head.kind == Token::Kind::kBad) {
      is_broken_ = true;
      read_.fail(Code::kBadToken, head.span, complaint_about(head).cause, "");
      return;
    }
    keyword_ = head.span;
    const auto is_read = read_statement(head.text, s);
    if (!is_read) unknown_statement(head, s);
    if (!is_read.value_or(false) || !read_.line_ends(s)) is_broken_ = true;
  }

  // One mistake, one message: the lines that follow belong to a test, or to the rule.
  void unknown_statement(const Token& head, Scanner& s) {
    if (is_time_last(head, s)) return;
    if (is_of_rules(upper_case(head.text)) && std::exchange(has_line_of_rules_, true)) return;
    if (fail_unknown_statement(read_, source_, head, all_keywords()) != "TEST") return;
    const std::size_t complaints = read_.complaints();
    test(s);
    read_.forget_since(complaints);
  }

  // "camera KILLED AT 2s": reported.
  bool is_time_last(const Token& head, const Scanner& s) {
    const std::string component(head.text);
    const std::string incident(s.peek().text);
    const bool is_incident = incident == "KILLED" || incident == "STOPPED" || incident == "HUNG";
    return is_incident && names_.is_component(component) &&
           !read_.fail(Code::kUnknownStatement, head.span,
                       "no statement begins with '" + component + "'",
                       "write the time first: AT 2s " + component + " " + incident);
  }

  // Empty if no statement begins with `keyword`.
  std::optional<bool> read_statement(std::string_view keyword, Scanner& s) {
    for (const std::string_view known : SetupReader::keywords()) {
      if (keyword != known) continue;
      has_scenario_ = !suite_.tests.empty();
      const bool is_good = setup_.read(keyword, s, scenario());
      if (is_good && has_scenario_) keep_moment(keyword);
      return is_good;
    }
    for (const Statement& known : kStatements) {
      if (keyword == known.keyword) return (this->*known.read)(s);
    }
    return std::nullopt;
  }

  // When the first change that a line of the test describes comes. A course may go on after the test.
  void keep_moment(std::string_view keyword) {
    const Scenario& here = scenario();
    Duration first{};
    if (keyword == "AT") first = here.incidents.back().at;
    if (keyword == "GOAL") first = here.goals.back().from;
    if (keyword == "LOG") first = here.logs.back().from;
    const bool is_course =
        keyword == "TOPIC" || keyword == "SIGNAL" || keyword == "LEVEL" || keyword == "PARAMETER";
    if (is_course) {
      const auto& stretches = here.courses.back().stretches;
      first = stretches.empty() ? first : stretches.front().from;
    }
    moments_.push_back({keyword_, first});
  }

  static std::vector<std::string_view> all_keywords() {
    std::vector<std::string_view> keywords = SetupReader::keywords();
    for (const Statement& known : kStatements) keywords.push_back(known.keyword);
    return keywords;
  }

  Scenario& scenario() {
    return suite_.tests.empty() ? suite_.shared : suite_.tests.back().scenario;
  }

  bool inside_test(std::string_view what) {
    if (!suite_.tests.empty()) return true;
    if (std::exchange(has_stray_line_, true)) return false;  // one TEST line is missing
    return read_.fail(Code::kOutOfPlace, keyword_, std::string(what) + " stands outside of a test",
                      what == "RUN" ? "write it below the TEST line: each test has its own length"
                                    : "begin one with TEST \"name\"");
  }

  // ---- the file and its tests

  // Its paths are read by rule_files(), which also reports their errors.
  bool rules_line(Scanner& s) {
    if (!suite_.tests.empty())
      return read_.fail(Code::kOutOfPlace, keyword_, "RULES stands inside a test",
                        "it holds for the whole file: write it before the first TEST");
    s = Scanner(source_.text(), {s.rest().end, s.rest().end});
    return true;
  }

  bool test(Scanner& s) {
    end_test();
    auto name = read_.name_or_text(s, "the test's name, in quotes if it has blanks");
    suite_.tests.emplace_back();
    suite_.tests.back().span = keyword_;
    is_broken_ = false;
    has_scenario_ = false;
    moments_.clear();
    if (!name) return false;
    const bool is_quoted = source_.text()[name->span.begin] == '"';
    if (name->text.starts_with('\'') && s.peek().kind == Token::Kind::kIdentifier)
      return read_.fail(
          Code::kSyntax, name->span, "a name with blanks stands in double quotes",
          "write TEST \"" + name->text.substr(1) + " " + std::string(s.peek().text) + " ...\"");
    if (!is_quoted && s.peek().kind == Token::Kind::kIdentifier)
      return read_.fail(Code::kSyntax, s.peek().span, "a name with blanks stands in quotes",
                        "write TEST \"" + name->text + " " + std::string(s.peek().text) + " ...\"");
    if (!test_names_.insert(name->text).second)
      return read_.fail(Code::kDuplicateName, name->span,
                        "another test of this file is called '" + name->text + "'",
                        "give each test a name of its own");
    suite_.tests.back().span = name->span;
    suite_.tests.back().name = std::move(name->text);
    return true;
  }

  void end_test() {
    if (suite_.tests.empty() || is_broken_) return;
    const Test& test = suite_.tests.back();
    if (test.length == Duration::zero() && test.bag.empty() && !has_stray_run_)
      read_.fail(Code::kIncomplete, test.span, "this test does not say how long it runs",
                 "add for example RUN 10s");
    if (!test.bag.empty() && has_scenario_)
      read_.fail(Code::kOutOfPlace, test.span,
                 "a test of a BAG has no script: the recording says what happens",
                 "keep RUN and EXPECT, and write another test for the script");
    if (test.expectations.empty())
      read_.fail(Code::kIncomplete, test.span, "this test expects nothing",
                 "add for example EXPECT SomeRule RESOLVED BY 5s");
    for (const Moment& each : moments_) {
      if (test.length > Duration::zero() && each.begins >= test.length)
        read_.fail(Code::kEmptyRange, each.span,
                   "the test is over after " + to_string(test.length) + ", before this happens",
                   "let it RUN longer, or write an earlier time");
    }
    for (const Expectation& e : test.expectations) {
      if (test.length > Duration::zero() && (e.by.value_or(e.after) > test.length))
        read_.fail(Code::kEmptyRange, e.span,
                   "the test is over after " + to_string(test.length) + ", before this time",
                   "let it RUN longer");
    }
  }

  bool run(Scanner& s) {
    if (suite_.tests.empty() && !has_stray_line_) has_stray_run_ = true;
    if (!inside_test("RUN")) return false;
    Test& test = suite_.tests.back();
    const Span span = s.peek().span;
    const auto length = read_.positive_duration(s, "how long the test runs");
    if (!length) return false;
    if (test.length != Duration::zero())
      return read_.fail(Code::kDuplicateName, keyword_, "the length of this test is set already",
                        "keep one RUN line");
    test.length = std::min(*length, kLongestRun);
    if (*length > kLongestRun)
      return read_.fail(Code::kPolicyRange, span, "a test runs at most 1h",
                        "write a shorter time, at most 1h");
    return true;
  }

  bool bag(Scanner& s) {
    if (!inside_test("BAG")) return false;
    auto path = read_.name_or_text(s, "the path of a recording, in quotes");
    if (!path) return false;
    Test& test = suite_.tests.back();
    if (!test.bag.empty())
      return read_.fail(Code::kDuplicateName, keyword_, "this test has a recording already",
                        "keep one BAG line");
    test.bag = std::move(path->text);
    return true;
  }

  bool expect(Scanner& s) {
    if (!inside_test("EXPECT")) return false;
    auto expectation = read_expectation(s, read_, names_);
    if (!expectation) return false;
    const Span rest = s.rest();
    expectation->span = {keyword_.begin, rest.begin};
    suite_.tests.back().expectations.push_back(*expectation);
    return true;
  }

  // ---- how the robot answers

  bool adaptation(Scanner& s) {
    has_scenario_ = !suite_.tests.empty();
    return read_answers_of_adaptation(s, read_, names_, rules_, scenario());
  }
  bool strategy(Scanner& s) {
    has_scenario_ = !suite_.tests.empty();
    return read_answers_of_strategy(s, read_, names_, rules_, scenario());
  }

  const Source& source_;
  const RuleSet& rules_;
  LineReader read_;
  Names names_;
  SetupReader setup_;
  std::vector<Diagnostic>& diagnostics_;
  Suite suite_;
  std::unordered_set<std::string> test_names_;
  struct Moment {
    Span span;
    Duration begins{};
  };
  std::vector<Moment> moments_;     // of the lines of the test under way
  bool has_scenario_ = false;       // the test under way says what happens
  bool has_stray_run_ = false;      // a RUN is what was reported outside of a test
  bool has_stray_line_ = false;     // outside of a test, which was reported
  bool has_line_of_rules_ = false;  // which was reported
  bool is_broken_ = false;  // a line of the test under way; what follows from it is not reported
  Span keyword_;
};

const std::array<Reader::Statement, Reader::kStatementCount> Reader::kStatements = {{
    {"RULES", &Reader::rules_line},
    {"ADAPTATION", &Reader::adaptation},
    {"STRATEGY", &Reader::strategy},
    {"TEST", &Reader::test},
    {"EXPECT", &Reader::expect},
    {"RUN", &Reader::run},
    {"BAG", &Reader::bag},
}};

}  // namespace

std::vector<Name> rule_files(const Source& source, std::vector<Diagnostic>& diagnostics) {
  std::vector<Name> files;
  LineReader read(source, diagnostics);
  for (std::uint32_t line = 1; line <= source.line_count(); ++line) {
    Scanner s(source.text(), source.line(line));
    if (s.next().text != "RULES") continue;
    if (const Token& next = s.peek(); next.is(":") || next.is("=")) {
      read.fail_token(next, "the path of a rule file", "");
      break;
    }
    do {
      if (const Token next = s.peek(); next.is(",")) {
        read.fail_token(next, "the path of a rule file", "");
        break;
      }
      auto name = read.name_or_text(s, "the path of a rule file");
      if (!name) break;
      if (name->text.starts_with("\u201c") || name->text.starts_with("\u2018")) {
        read.fail(Code::kBadToken, name->span, "this path has typographic quotes",
                  "write the straight quote of the keyboard: \"");
        break;
      }
      files.push_back(std::move(*name));
    } while (!s.at_end());
  }
  if (files.empty() && diagnostics.empty()) {
    const std::string own = source.name().substr(source.name().rfind('/') + 1);
    read.fail(Code::kIncomplete, {}, "this file does not say which rules it tests",
              own.ends_with(".rules")
                  ? "a test is a file of its own, which begins with RULES " + own
                  : "begin it with RULES and a path, relative to this file");
  }
  return files;
}

Suite read_suite(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics) {
  return Reader(source, rules, diagnostics).read();
}

}  // namespace culprit::rule_test
