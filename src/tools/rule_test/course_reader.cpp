#include "rule_test/course_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knowledge/signal_store.h"
#include "language/typing.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

// "10Hz": a rate is a name to the scanner.
std::optional<double> rate_of(const std::string& text) {
  if (!text.ends_with("Hz") || text.size() > 32) return std::nullopt;
  const Value number = value_from_text(text.substr(0, text.size() - 2));
  if (const auto* whole = std::get_if<std::int64_t>(&number)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&number)) return *real;
  return std::nullopt;
}

class CourseReader {
 public:
  CourseReader(Scanner& scanner, LineReader& read, const RuleSet& rules)
      : s_(scanner), read_(read), rules_(rules) {}

  std::optional<Course> course(Subject subject) {
    Course course{subject, {}, {}};
    const bool is_sampled =
        std::holds_alternative<SignalId>(subject) || std::holds_alternative<DiagnosticId>(subject);
    if (is_sampled && s_.peek().text == "EVERY") {
      s_.next();
      const Span span = s_.peek().span;
      course.period = read_.duration(s_, "how often it is read");
      if (!course.period) return std::nullopt;
      if (*course.period < kShortestPeriod) {
        read_.fail(Code::kPolicyRange, span, "at least 1ms must pass between readings", "");
        return std::nullopt;
      }
    }
    if (begins_with_value()) {
      Stretch always;
      if (!value(subject, always)) return std::nullopt;
      course.stretches.push_back(std::move(always));
      if (s_.at_end()) return course;
    }
    do {
      if (!stretch(course)) return std::nullopt;
    } while (!s_.at_end());
    return course;
  }

 private:
  // "10Hz" without a time: from the start on. A number before a ':' is a time without its unit.
  bool begins_with_value() const {
    if (s_.at_end()) return false;
    Scanner ahead = s_;
    const Token first = ahead.next();
    return first.kind != Token::Kind::kDuration && !ahead.peek().is(":") && !ahead.peek().is("..");
  }

  // "2s: value", "2s..5s: value"
  bool stretch(Course& course) {
    Stretch stretch;
    const auto from = read_.duration(s_, "a time, as in 2s: or 2s..5s:");
    if (!from) return false;
    stretch.from = *from;
    if (const Token& next = s_.peek(); next.is("-"))
      return read_.fail(Code::kSyntax, next.span, "unexpected '-' between two times", "write '..'",
                        Edit{next.span, ".."});
    if (s_.peek().is("..")) {
      s_.next();
      const Span span = s_.peek().span;
      stretch.until = read_.duration(s_, "a time");
      if (!stretch.until) return false;
      if (*stretch.until <= stretch.from)
        return read_.fail(Code::kEmptyRange, span, "this time is not after the one before",
                          "write the earlier time first");
      if (std::holds_alternative<ParameterId>(course.subject))
        return read_.fail(Code::kSyntax, span, "a parameter keeps its value until it is set again",
                          "write the time from which on it has it, as in 2s: true");
    }
    if (!read_.expect_symbol(s_, ":", "write a ':' behind the time, as in 2s: silent"))
      return false;
    if (!value(course.subject, stretch)) return false;
    course.stretches.push_back(std::move(stretch));
    return true;
  }

  bool value(Subject subject, Stretch& stretch) {
    const bool is_parameter = std::holds_alternative<ParameterId>(subject);
    if (s_.peek().text == "silent" && s_.peek().kind == Token::Kind::kIdentifier && !is_parameter) {
      s_.next();
      return true;
    }
    if (std::holds_alternative<TopicId>(subject)) return rate(stretch);
    const std::uint32_t begin = s_.position();
    stretch.value = literal();
    if (!stretch.value) return false;
    const Span span{begin, std::max(begin, last_end_)};
    if (std::holds_alternative<DiagnosticId>(subject)) return is_level(*stretch.value, span);
    if (const auto* id = std::get_if<SignalId>(&subject)) return fits(*stretch.value, *id, span);
    return true;
  }

  bool rate(Stretch& stretch) {
    const Name name = s_.next_name();
    if (const auto end = name.span.end; name.text.ends_with(';') && name.text.size() > 1)
      return read_.fail(Code::kSyntax, {end - 1, end}, "unexpected ';' between two times",
                        "remove the ';'", Edit{{end - 1, end}, ""});
    const auto rate = rate_of(name.text);
    if (!rate)
      return read_.fail(Code::kSyntax, name.span, "expected a rate, or silent",
                        remedy_of_rate(name.text));
    if (!(*rate > 0 && *rate <= kHighestRate))
      return read_.fail(Code::kPolicyRange, name.span, "a rate is above 0Hz and at most 1000Hz",
                        "write silent where nothing comes");
    stretch.value = Value(*rate);
    return true;
  }

  static std::string remedy_of_rate(const std::string& written) {
    if (written.empty()) return "a rate is written like 10Hz";
    if (upper_case(written) == "AT" || upper_case(written).starts_with("STOP"))
      return "write the time, a ':' and silent, as in 2s: silent";
    if (written.find_first_not_of("0123456789.") == std::string::npos)
      return "write " + written + "Hz";
    const bool has_digit = written.find_first_of("0123456789") != std::string::npos;
    return has_digit ? "a rate is written like 10Hz"
                     : "write silent where nothing comes, or a rate like 10Hz";
  }

  std::optional<Value> literal() {
    const bool negative = s_.peek().is("-");
    if (negative) s_.next();
    const Token token = s_.next();
    last_end_ = token.span.end;
    const bool is_truth =
        token.kind == Token::Kind::kIdentifier && (token.text == "true" || token.text == "false");
    if (token.kind == Token::Kind::kNumber && s_.peek().is("%")) {
      read_.fail(Code::kSyntax, s_.peek().span, "unexpected '%' after a number",
                 "remove it; where the rules use a share from 0 to 1, write 0.8 for 80 percent",
                 Edit{s_.peek().span, ""});
      return std::nullopt;
    }
    if (token.kind == Token::Kind::kNumber) {
      if (const auto* whole = std::get_if<std::int64_t>(&token.literal))
        return Value(negative ? -*whole : *whole);
      const double number = std::get<double>(token.literal);
      return Value(negative ? -number : number);
    }
    if (!negative && is_truth) return Value(token.text == "true");
    if (token.kind == Token::Kind::kIdentifier && token.text == "nan")
      return Value(std::numeric_limits<double>::quiet_NaN());
    if (!negative && token.kind == Token::Kind::kString)
      return Value(std::get<std::string>(token.value()));
    read_.fail_token(token, "a value", "a value is true, false, a number, or a text in quotes");
    return std::nullopt;
  }

  bool fits(const Value& value, SignalId id, Span span) {
    std::string text;
    const Type type = rules_[id].type;
    const std::string a_type = describe(type);
    if (std::holds_alternative<std::string>(value) && type != Type::kString)
      return read_.fail(Code::kTypeMismatch, span,
                        rules_[id].name + " is " + a_type + " in the rules, and this is a text",
                        as_type(value, type, text).known ? "remove the quotes" : "write " + a_type);
    const auto* number = std::get_if<double>(&value);
    const bool is_nan = number != nullptr && std::isnan(*number);
    if (is_nan ? type == Type::kDouble : as_type(value, type, text).known) return true;
    return read_.fail(Code::kTypeMismatch, span,
                      rules_[id].name + " is " + a_type + " in the rules, and this is none",
                      type == Type::kString ? "write it in quotes" : "write " + a_type);
  }

  bool is_level(const Value& value, Span span) {
    const auto* level = std::get_if<std::int64_t>(&value);
    if (level != nullptr && *level >= 0 && *level <= 3) return true;
    return read_.fail(Code::kPolicyRange, span,
                      "a level is 0 (OK), 1 (WARN), 2 (ERROR) or 3 (STALE)", "");
  }

  Scanner& s_;
  LineReader& read_;
  const RuleSet& rules_;
  std::uint32_t last_end_ = 0;  // of the last value
};

}  // namespace

std::optional<Course> read_course(Scanner& scanner, LineReader& read, const RuleSet& rules,
                                  Subject subject) {
  return CourseReader(scanner, read, rules).course(subject);
}

}  // namespace culprit::rule_test
