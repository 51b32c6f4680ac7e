#include <algorithm>
#include <array>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "rule_test/names.h"
#include "rule_test/reader.h"
#include "rule_test/setup_reader.h"
#include "rule_test/state.h"

namespace culprit::rule_test {
namespace {

class StateReader {
 public:
  StateReader(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics)
      : source_(source),
        read_(source, diagnostics),
        names_(rules, diagnostics),
        setup_(source, rules, read_, names_) {}

  State read() {
    for (std::uint32_t line = 1; line <= source_.line_count(); ++line) {
      Scanner scanner(source_.text(), source_.line(line));
      if (scanner.at_end()) continue;
      if (is_test(scanner)) break;
      if (statement(scanner)) read_.line_ends(scanner);
      has_statement_ = true;
    }
    return std::move(state_);
  }

 private:
  // A test begins with RULES. Reported: none of its lines says more.
  bool is_test(const Scanner& s) {
    const Token& head = s.peek();
    return !has_statement_ && head.text == "RULES" &&
           !read_.fail(Code::kOutOfPlace, head.span, "this file is a test, and no state",
                       "culprit test runs it; a state says only how the robot is");
  }

  bool statement(Scanner& s) {
    const Token head = s.next();
    if (head.kind == Token::Kind::kBad)
      return read_.fail(Code::kBadToken, head.span, complaint_about(head).cause, "");
    const auto is_one_of = [&](const auto& keywords) {
      return std::find(keywords.begin(), keywords.end(), head.text) != keywords.end();
    };
    if (is_one_of(SetupReader::keywords())) return setup_.read(head.text, s, state_.scenario);
    if (head.text == "RUN") return run(s, head.span);
    if (head.text == "STRATEGY") return strategy(s);
    constexpr std::array<std::string_view, 4> kOfTests = {"RULES", "TEST", "ADAPTATION", "EXPECT"};
    if (is_one_of(kOfTests))
      return read_.fail(Code::kOutOfPlace, head.span,
                        std::string(head.text) + " belongs into a test, and this is a state",
                        "remove the line: a state says only how the robot is");
    std::vector<std::string_view> keywords = SetupReader::keywords();
    keywords.insert(keywords.end(), {"STRATEGY", "RUN"});
    fail_unknown_statement(read_, source_, head, keywords);
    return false;
  }

  bool run(Scanner& s, Span keyword) {
    const Span span = s.peek().span;
    const auto moment = read_.positive_duration(s, "the moment of the state");
    if (!moment) return false;
    if (state_.moment)
      return read_.fail(Code::kDuplicateName, keyword, "the moment of this state is set already",
                        "keep one RUN line");
    if (*moment > kLongestRun)
      return read_.fail(Code::kPolicyRange, span, "a state runs at most 1h",
                        "write a shorter time, at most 1h");
    state_.moment = moment;
    return true;
  }

  // "STRATEGY rgb_restart TRIED HELPED 3 OF 8"
  bool strategy(Scanner& s) {
    const auto name = read_.name_or_text(s, "a strategy");
    const auto id = name ? names_.strategy(*name) : std::nullopt;
    if (!id) return false;
    do {
      const Token clause = s.next();
      if (clause.text == "TRIED") {
        state_.tried.push_back(*id);
      } else if (clause.text == "HELPED") {
        if (!helped(s, *id)) return false;
      } else {
        return read_.unexpected_clause(clause, {"TRIED", "HELPED"});
      }
    } while (!s.at_end());
    return true;
  }

  bool helped(Scanner& s, StrategyId strategy) {
    const auto helped = times(s, "how often it helped");
    if (!helped || !read_.expect_word(s, "OF")) return false;
    const Span span = s.peek().span;
    const auto all = times(s, "how often it was executed");
    if (!all) return false;
    if (*all < *helped)
      return read_.fail(Code::kEmptyRange, span, "it cannot have helped more often than that", "");
    state_.experiences.push_back({strategy, *helped, *all - *helped});
    return true;
  }

  std::optional<int> times(Scanner& s, std::string_view what) {
    constexpr std::int64_t kMost = 1'000'000;
    const Span span = s.peek().span;
    const auto number = read_.whole_number(s, what);
    if (!number) return std::nullopt;
    if (*number <= kMost) return static_cast<int>(*number);
    read_.fail(Code::kPolicyRange, span, "at most 1000000 executions can be counted", "");
    return std::nullopt;
  }

  const Source& source_;
  LineReader read_;
  Names names_;
  SetupReader setup_;
  State state_;
  bool has_statement_ = false;
};

}  // namespace

State read_state(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics) {
  return StateReader(source, rules, diagnostics).read();
}

}  // namespace culprit::rule_test
