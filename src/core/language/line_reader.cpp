#include "language/line_reader.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/joined.h"
#include "language/expression_parser.h"
#include "language/foreign_operators.h"
#include "language/foreign_words.h"
#include "language/reserved_words.h"

namespace culprit {
namespace {

using syntax::Name;

bool is_ros_name(std::string_view name) {
  if (name.size() < 2 || name.front() != '/' || name.back() == '/') return false;
  for (std::size_t i = 1; i < name.size(); ++i) {
    const char c = name[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool digit = c >= '0' && c <= '9';
    const bool begins_token = name[i - 1] == '/';
    if (!letter && !(digit && !begins_token) && !(c == '/' && !begins_token)) return false;
  }
  return true;
}

// With a letter for each parameter; one in front may be a whole name.
std::string filled(std::string_view name) {
  std::string out = hole_length(name) > 0 ? "/" : "";
  while (!name.empty()) {
    const std::size_t hole = hole_length(name);
    out += hole > 0 ? 'x' : name.front();
    name.remove_prefix(std::max<std::size_t>(hole, 1));
  }
  return out;
}

// `word` in lower case, or with a slip of the fingers.
bool is_nearly(const Token& token, std::string_view word) {
  const std::string upper = upper_case(token.text);
  return token.kind == Token::Kind::kIdentifier &&
         (upper == word || !closest(upper, {word}).empty());
}

bool is_unclosed(const Token& token) { return token.flaw == Token::Flaw::kUnclosed; }

constexpr std::string_view kNameRemedy =
    "a name is made of letters, digits and '_', and begins with no digit";

// A sign that other languages put between the parts of a line.
bool is_separator(const Token& token) { return token.is(":") || token.is("=") || token.is(","); }

// A bracket stands where another token was expected: the place says more than the character.
bool is_bracket(const Token& token, std::string_view written) {
  return token.flaw == Token::Flaw::kMeaningless &&
         std::string_view("{}[]").find(written) != std::string_view::npos;
}

// The words of a text in quotes as one name; empty: it cannot be one.
std::string as_name(std::string_view text) {
  std::string name;
  for (const char c : trimmed(text)) name += c == ' ' || c == '-' ? '_' : c;
  return is_component_reference(name) && !name.starts_with('/') ? name : "";
}

// Words that people write in front of a number.
bool is_label_of_number(std::string_view word) {
  constexpr std::array<std::string_view, 9> kLabels = {
      "PROBABILITY", "PROB", "P", "CONFIDENCE", "CONF", "C", "IMPACT", "CYCLES", "SUCCESS"};
  return std::ranges::find(kLabels, upper_case(word)) != kLabels.end();
}

}  // namespace

bool is_type_word(std::string_view word) {
  constexpr std::array<std::string_view, 9> kTypes = {
      "float", "double", "int", "bool", "string", "auto", "duration", "number", "float64"};
  return std::ranges::find(kTypes, word) != kTypes.end();
}

bool is_component_reference(std::string_view name) {
  return name.starts_with('/')
             ? is_ros_name(name)
             : is_ros_name("/" + std::string(name)) && name.find('/') == std::string_view::npos;
}

std::string remedy_of_ros_name(std::string_view name) {
  const std::string written(name);
  if (is_ros_name("/" + written)) {
    return name.find('/') != std::string_view::npos
               ? "write /" + written
               : "write /" + written + ", or with its namespace: /namespace/" + written;
  }
  if (name.starts_with('~')) return "write the full name, with the node's namespace: /robot/camera";
  if (name.find('*') != std::string_view::npos)
    return "there are no wildcards: write each full name";
  if (name.ends_with('/') && is_ros_name(name.substr(0, name.size() - 1)))
    return "write " + written.substr(0, written.size() - 1);
  if (const auto dot = name.find('.');
      dot != std::string_view::npos && is_ros_name(name.substr(0, dot)))
    return "write the topic and the field apart: " + written.substr(0, dot) + " FIELD " +
           written.substr(dot + 1);
  return "full names look like /namespace/name: letters, digits and '_' between slashes";
}

std::string upper_case(std::string_view word) {
  std::string text(word);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::optional<Name> LineReader::identifier(Scanner& s, std::string_view what) {
  const Token token = s.next();
  if (token.kind == Token::Kind::kIdentifier) return Name{std::string(token.text), token.span};
  if (token.flaw == Token::Flaw::kNumber) {
    fail(Code::kBadToken, token.span,
         "'" + std::string(source_.text(token.span)) + "' begins with a digit",
         std::string(kNameRemedy));
    return std::nullopt;
  }
  if (token.kind == Token::Kind::kString) {
    const std::string name = as_name(std::get<std::string>(token.value()));
    const std::string remedy = name.empty() ? kNameRemedy.data() : "write " + name;
    fail(Code::kSyntax, token.span, "a name has no quotes", remedy,
         name.empty() ? std::nullopt : std::optional(Edit{token.span, name}));
    return std::nullopt;
  }
  const bool is_missing = token.kind == Token::Kind::kEnd || token.kind == Token::Kind::kNumber;
  fail_token(token, what, is_missing ? "write a name here" : std::string(kNameRemedy));
  return std::nullopt;
}

std::optional<Name> LineReader::declared_name(Scanner& s, std::string_view what) {
  auto name = identifier(s, what);
  if (name && is_word_of_language(name->text)) {
    fail(Code::kReservedWord, name->span, "'" + name->text + "' is a word of the language",
         "choose another name");
    return std::nullopt;
  }
  if (name && has_dot(s, *name)) return std::nullopt;
  return name;
}

bool LineReader::has_dot(const Scanner& s, const Name& name) {
  Scanner ahead = s.ahead();
  Span span = name.span;
  std::string meant = name.text;
  for (Token dot = ahead.next(); source_.text(dot.span) == "." && dot.span.begin == span.end;
       dot = ahead.next()) {
    const Token word = ahead.next();
    if (word.kind != Token::Kind::kIdentifier || word.span.begin != dot.span.end) break;
    meant += "_" + std::string(word.text);
    span.end = word.span.end;
  }
  return span != name.span &&
         !fail(Code::kSyntax, span, "a name has no '.' in it", "write " + meant, Edit{span, meant});
}

std::optional<Name> LineReader::name_or_text(Scanner& s, std::string_view what) {
  if (const std::uint32_t at = s.position();
      at < source_.text().size() && source_.text()[at] == '"') {
    if (const Token& token = s.peek(); is_unclosed(token)) {
      fail_token(token, what, "");
      return std::nullopt;
    }
  }
  Name name = s.next_name();
  if (name.text.ends_with('$') && s.peek().is("(")) {
    fail(Code::kSyntax, {name.span.end - 1, s.peek().span.end},
         "'$(' begins a substitution of a launch file, which nothing evaluates here",
         "write the path or the name in full");
    return std::nullopt;
  }
  if (!name.text.empty() && name.text.size() <= Scanner::kMaxName) return name;
  fail(Code::kSyntax, name.span, "expected " + std::string(what),
       !name.text.empty() ? "it is too long for a name"
       : s.at_end()       ? "it is missing at the end of this line"
       : source_.text(name.span) == "\"\""
           ? "write it between the quotes"
           : "blanks, commas and parentheses stand in a name only in quotes");
  return std::nullopt;
}

std::optional<Name> LineReader::component_reference(Scanner& s) {
  if (s.position() < source_.text().size() && source_.text()[s.position()] == '/')
    return ros_name(s, "a component");
  if (s.peek().is("*")) {
    fail(Code::kSyntax, s.peek().span, "no sign stands for all components",
         "write a line for each component");
    return std::nullopt;
  }
  auto name = identifier(s, "a component");
  if (!name || !is_word_of_language(name->text)) return name;
  const std::string line(statement_of_clause(name->text));
  fail(Code::kReservedWord, name->span, "'" + name->text + "' is a word of the language",
       line.empty() ? "write the component in front of it"
                    : "write the component here, and " + name->text + " on the " + line + " line");
  return std::nullopt;
}

std::optional<Name> LineReader::ros_name(Scanner& s, std::string_view what) {
  if (const Token& token = s.peek(); token.is(":") || token.is("=")) {
    fail_token(token, what, "");
    return std::nullopt;
  }
  auto name = name_or_text(s, what);
  if (!name || is_ros_name(name->text)) return name;
  if (s.allows_holes() && is_ros_name(filled(name->text))) return name;
  fail(Code::kBadRosName, name->span, "'" + name->text + "' is no full ROS name",
       remedy_of_ros_name(name->text));
  return std::nullopt;
}

std::optional<Name> LineReader::text(Scanner& s, std::string_view what, std::string_view remedy) {
  const Token token = s.next();
  if (token.kind == Token::Kind::kString)
    return Name{std::get<std::string>(token.value()), token.span};
  if (auto slip = letter_before_text(token, s)) {
    diagnostics_.push_back(std::move(*slip));
    return std::nullopt;
  }
  fail_token(token, what, std::string(remedy));
  return std::nullopt;
}

std::optional<Duration> LineReader::duration(Scanner& s, std::string_view what) {
  const Token token = s.next();
  if (token.kind == Token::Kind::kDuration) return std::get<Duration>(token.literal);
  if (token.has_hole) return Duration(1);
  std::string remedy = "a duration is a number and its unit, as in 500ms or 2s";
  std::optional<Edit> fix;
  const Token unit = s.peek();
  const std::string one_word = std::string(source_.text(token.span)).append(unit.text);
  const std::string number(source_.text(token.span));
  if (fail_foreign_duration(token, s)) return std::nullopt;
  if (unit.kind == Token::Kind::kIdentifier && parse_duration(one_word)) {
    remedy = "write " + one_word + ", without the blank";
    fix = {{token.span.begin, unit.span.end}, one_word};
  } else if (token.kind == Token::Kind::kNumber && !duration_unit(unit.text).empty()) {
    const std::string meant = number + std::string(duration_unit(unit.text));
    remedy = "write " + meant;
    fix = {{token.span.begin, unit.span.end}, meant};
  } else if (token.kind == Token::Kind::kNumber) {
    remedy = "add the unit: " + number + "s or " + number + "ms";
  } else if (token.is("-")) {
    remedy = "write a positive duration";
  }
  fail_token(token, what, std::move(remedy), std::move(fix));
  return std::nullopt;
}

bool LineReader::fail_foreign_duration(const Token& token, const Scanner& behind) {
  Scanner ahead = behind.ahead();
  const Token second = ahead.next();
  const std::string written(source_.text(token.span));
  if (token.kind == Token::Kind::kIdentifier && second.kind == Token::Kind::kDuration)
    return !fail(Code::kSyntax, token.span, "unexpected '" + written + "' before a duration",
                 "remove it", Edit{{token.span.begin, second.span.begin}, ""});
  const auto* minutes = std::get_if<std::int64_t>(&token.literal);
  const Token third = ahead.next();
  Span all{token.span.begin, third.span.end};
  if (const std::string meant = written + "." + std::string(source_.text(third.span));
      second.is(",") && third.kind == Token::Kind::kDuration && parse_duration(meant))
    return !fail(Code::kSyntax, all, "a number has a point, and no comma", "write " + meant,
                 Edit{all, meant});
  const auto* seconds = std::get_if<std::int64_t>(&third.literal);
  constexpr std::int64_t kMost = 100'000;
  if (second.is(":") && minutes != nullptr && seconds != nullptr && *minutes < kMost &&
      *seconds < 60) {
    std::int64_t sum = *minutes * 60 + *seconds;
    const bool has_hours = ahead.next().is(":");
    const Token fifth = ahead.next();
    if (const auto* last = std::get_if<std::int64_t>(&fifth.literal);
        has_hours && last != nullptr && *last < 60) {
      sum = sum * 60 + *last;
      all.end = fifth.span.end;
    }
    const std::string meant = to_string(Duration(std::chrono::seconds(sum)));
    return !fail(Code::kSyntax, all, "a duration is a number and its unit", "write " + meant,
                 Edit{all, meant});
  }
  return false;
}

std::optional<Duration> LineReader::positive_duration(Scanner& s, std::string_view what) {
  const Span span = s.peek().span;
  const auto d = duration(s, what);
  if (!d || *d > Duration::zero()) return d;
  fail(Code::kPolicyRange, span, "this duration must be longer than zero",
       "write for example 500ms, or leave it out with its keyword");
  return std::nullopt;
}

std::optional<syntax::Number> LineReader::number(Scanner& s, std::string_view what,
                                                 std::string remedy) {
  const Token token = s.next();
  if (token.has_hole) return syntax::Number{1, true, token.span};
  if (token.kind == Token::Kind::kNumber) {
    if (const auto* whole = std::get_if<std::int64_t>(&token.literal)) {
      return syntax::Number{static_cast<double>(*whole), true, token.span};
    }
    return syntax::Number{std::get<double>(token.literal), false, token.span};
  }
  std::optional<Edit> fix;
  if (token.kind == Token::Kind::kIdentifier && is_label_of_number(token.text) && !s.at_end()) {
    const bool has_sign = s.peek().is("=") || s.peek().is(":");
    const Span label{token.span.begin, has_sign ? s.peek().span.end : s.position()};
    fail(Code::kSyntax, token.span, "unexpected '" + std::string(token.text) + "' before a number",
         "write only the number", Edit{label, ""});
    return std::nullopt;
  }
  if (token.kind == Token::Kind::kEnd && remedy.empty())
    remedy = "a number is missing at the end of this line";
  if (token.is("%")) {
    const bool separates = s.position() == token.span.end;  // the next number follows at once
    fail(Code::kSyntax, token.span, "unexpected '%' after a number",
         "remove it: a probability is in percent already", Edit{token.span, separates ? " " : ""});
    return std::nullopt;
  }
  if (token.is("-")) remedy = "write a positive number";
  if (token.is("/") && remedy.empty()) {
    remedy = "write a blank between the numbers";
    fix = Edit{token.span, " "};
  }
  if (token.kind == Token::Kind::kDuration && remedy.empty())
    remedy = "write a number without a unit";
  if (token.kind == Token::Kind::kIdentifier && remedy.empty()) remedy = "write a number in digits";
  fail_token(token, what, std::move(remedy), std::move(fix));
  return std::nullopt;
}

std::optional<std::int64_t> LineReader::whole_number(Scanner& s, std::string_view what) {
  const Token token = s.next();
  if (const auto* whole = std::get_if<std::int64_t>(&token.literal)) return *whole;
  if (token.has_hole) return 1;
  fail_token(token, what,
             token.kind == Token::Kind::kEnd ? "it is missing at the end of this line"
                                             : "write a whole number");
  return std::nullopt;
}

std::optional<double> LineReader::signed_number(Scanner& s) {
  const bool negative = s.peek().is("-");
  if (negative) s.next();
  const auto magnitude = number(s, "a number");
  if (!magnitude) return std::nullopt;
  return negative ? -magnitude->value : magnitude->value;
}

bool LineReader::expect_word(Scanner& s, std::string_view word, std::string remedy) {
  const Token token = s.next();
  if (token.text == word) return true;
  std::optional<Edit> fix;
  if (remedy.empty()) remedy = "write " + std::string(word) + " here";
  if (is_nearly(token, word)) {
    fix = {token.span, std::string(word)};
    remedy = "did you mean " + std::string(word) + "?";
  }
  return fail_token(token, word, std::move(remedy), std::move(fix));
}

bool LineReader::is_one_word(const Scanner& s, const Name& name,
                             std::span<const std::string_view> followers) {
  Scanner ahead = s.ahead();
  std::uint32_t end = name.span.end;
  bool has_dash = false;
  while (!ahead.at_end()) {
    const Token& token = ahead.peek();
    const bool adjoins = token.span.begin == end;
    const bool is_dash = token.is("-") && adjoins;
    const bool is_word = token.kind == Token::Kind::kIdentifier && !is_reserved(token.text) &&
                         !is_label_of_number(token.text);
    const bool is_number = token.kind == Token::Kind::kNumber && adjoins;
    if (token.has_hole || (!is_dash && !is_word && !is_number)) break;
    has_dash = has_dash || is_dash;
    end = ahead.next().span.end;
  }
  const auto follows = std::find(followers.begin(), followers.end(), ahead.peek().text);
  if (end == name.span.end || (!followers.empty() && follows == followers.end())) return true;
  const Span span{name.span.begin, end};
  if (is_type_word(name.text) && !has_dash) {
    const Span type{name.span.begin, s.peek().span.begin};
    return fail(Code::kSyntax, name.span, "unexpected type before a name",
                "remove '" + name.text + "'", Edit{type, ""});
  }
  std::string meant;
  for (const char c : source_.text(span)) {
    const bool is_break = c == '-' || is_blank(c);
    if (!is_break || !meant.ends_with('_')) meant += is_break ? '_' : c;
  }
  return fail(Code::kSyntax, span, has_dash ? "a name has no '-' in it" : "a name is one word",
              "write " + meant, Edit{span, meant});
}

bool LineReader::expect_symbol(Scanner& s, std::string_view symbol, std::string remedy) {
  const Token token = s.next();
  if (token.is(symbol)) return true;
  const bool is_other = token.kind == Token::Kind::kSymbol;
  if (remedy.empty() && is_other && !token.is("("))
    remedy = "write '" + std::string(symbol) + "' in its place";
  return fail_token(token, "'" + std::string(symbol) + "'", std::move(remedy),
                    is_other ? std::optional(Edit{token.span, std::string(symbol)}) : std::nullopt);
}

bool LineReader::fail(Code code, Span span, std::string cause, std::string remedy,
                      std::optional<Edit> fix) {
  diagnostics_.push_back(
      {code, Severity::kError, span, std::move(cause), std::move(remedy), std::move(fix)});
  return false;
}

bool LineReader::fail_token(const Token& token, std::string_view expected, std::string remedy,
                            std::optional<Edit> fix) {
  const std::string written(source_.text(token.span));
  if (is_separator(token) && expected != "'" + written + "'" && !fix) {
    return fail(Code::kSyntax, token.span, "no '" + written + "' stands here",
                "remove the '" + written + "'", Edit{token.span, blank_for(token)});
  }
  if (token.is("(") && (remedy.empty() || remedy == kNameRemedy)) remedy = "remove the parentheses";
  if (written == "{" && source_.text({token.span.begin, token.span.begin + 2}) == "{{")
    remedy = "a parameter of a TEMPLATE stands in one pair of braces, as in {name}";
  const bool is_of_place = is_bracket(token, written) && !remedy.empty();
  if (token.kind == Token::Kind::kBad && !is_of_place) {
    const auto [cause, its_fix, its_remedy] = complaint_about(token);
    if (!its_remedy.empty()) remedy = its_remedy;
    return fail(Code::kBadToken, token.span, cause, std::move(remedy), its_fix);
  }
  const std::string got = token.kind == Token::Kind::kEnd ? "" : ", not '" + written + "'";
  return fail(Code::kSyntax, token.span, "expected " + std::string(expected) + got,
              std::move(remedy), std::move(fix));
}

bool LineReader::unexpected_clause(const Token& token, std::vector<std::string_view> known,
                                   std::string remedy, Code code) {
  if (token.is(",")) return fail_comma(token);
  if (token.kind == Token::Kind::kBad) return fail_token(token, "", "");
  if (std::find(known.begin(), known.end(), token.text) != known.end()) {
    return fail(code, token.span, std::string(token.text) + " is given twice", "keep one of them");
  }
  if (is_separator(token)) return fail_token(token, "", "");
  const std::string list = joined(known);
  std::string near = upper_case(token.text);
  const bool is_known = std::find(known.begin(), known.end(), near) != known.end();
  const std::string_view foreign =
      is_known ? std::string_view() : clause_of_other_tools(token.text, known);
  if (!is_known) near = foreign.empty() ? closest(token.text, known) : "";
  if (near.empty() && foreign.empty()) near = closest(upper_case(token.text), known);
  const bool are_clauses = !known.empty() && upper_case(known.front()) == known.front();
  const std::string_view line = are_clauses ? statement_of_clause(token.text) : std::string_view();
  if (!near.empty() || !foreign.empty()) {
    remedy = "did you mean " + near + std::string(foreign) + "?";
  } else if (!line.empty() && remedy.empty()) {
    remedy = upper_case(token.text) + " belongs to the " + std::string(line) + " line";
  }
  const std::string got = token.kind == Token::Kind::kEnd
                              ? ""
                              : ", not '" + std::string(source_.text(token.span)) + "'";
  if (remedy.empty() && token.kind != Token::Kind::kEnd)
    remedy = "remove it, or write one of these words";
  if (!foreign.empty())
    return fail(code, token.span, "unexpected '" + std::string(token.text) + "' in this line",
                std::move(remedy));
  return fail(code, token.span, "expected one of " + list + got, std::move(remedy),
              replacement(token.span, near));
}

std::string LineReader::blank_for(const Token& separator) const {
  const std::string_view text = source_.text();
  const std::uint32_t end = separator.span.end;
  return end < text.size() && !is_blank(text[end]) ? " " : "";
}

bool LineReader::has_digit(std::uint32_t at) const {
  const std::string_view text = source_.text();
  return at < text.size() && text[at] >= '0' && text[at] <= '9';
}

bool LineReader::is_in_number(const Token& comma) const {
  return comma.is(",") && comma.span.begin > 0 && has_digit(comma.span.begin - 1) &&
         has_digit(comma.span.end);
}

bool LineReader::fail_comma_in_number(const Token& comma) {
  const std::uint32_t third = comma.span.end + 2;
  if (has_digit(third - 1) && has_digit(third) && !has_digit(third + 1))
    return fail(Code::kExtraText, comma.span, "a number has no comma",
                "leave it out if it separates thousands, or write a '.'");
  return fail(Code::kExtraText, comma.span, "a number has a point, and no comma", "write a '.'",
              Edit{comma.span, "."});
}

bool LineReader::fail_comma(const Token& comma) {
  const Span line = source_.line(source_.position(comma.span.begin).line);
  const std::string_view in_front = trimmed(source_.text({line.begin, comma.span.begin}));
  const bool is_adaptation = in_front.find("ADAPTATION ") != std::string_view::npos;
  if (in_front.starts_with("SIGNAL ") && std::ranges::count(in_front, ' ') == 1)
    return fail(Code::kExtraText, comma.span, "one line declares one signal",
                "write a line for each");
  if (is_adaptation)
    return fail(Code::kExtraText, comma.span, "one line has one adaptation",
                "write the next one on a line of its own that begins with ADAPTATION");
  return fail(Code::kExtraText, comma.span, "unexpected ',' between the parts of a line",
              "remove the ','", Edit{comma.span, ""});
}

bool LineReader::line_ends(Scanner& s, std::string_view remedy) {
  const Token& token = s.peek();
  if (token.kind == Token::Kind::kEnd) return true;
  if (token.kind == Token::Kind::kBad) return fail_token(token, "", "");
  struct Slip {
    std::string_view written, meant, remedy;
  };
  constexpr std::array<Slip, 5> kSlips = {
      {{"when", "WHEN", "write WHEN in upper case"},
       {"lastresort", "LASTRESORT", "write LASTRESORT in upper case"},
       {"within", "WITHIN", "write WITHIN in upper case"},
       {":", "", "remove the ':'"},
       {")", "", "remove the ')', which closes nothing"}}};
  constexpr std::string_view kCause = "this text does not belong to the line";
  for (const Slip& slip : kSlips) {
    if (token.text == slip.written)
      return fail(Code::kExtraText, token.span, std::string(kCause), std::string(slip.remedy),
                  Edit{token.span, std::string(slip.meant)});
  }
  if (is_in_number(token)) return fail_comma_in_number(token);
  if (token.is(",")) return fail_comma(token);
  if (const Span sign{token.span.begin, token.span.begin + 2}; source_.text(sign) == "/*")
    return fail(Code::kExtraText, sign, "no comment begins with '/*'", "begin a comment with #",
                Edit{sign, "#"});
  // The scanner takes the two characters for signs.
  const std::string_view text = source_.text();
  const Span line = source_.line(source_.position(token.span.begin).line);
  const auto dashes = text.substr(0, token.span.begin).rfind(" --");
  if (dashes != std::string_view::npos && dashes >= line.begin) {
    const auto begin = static_cast<std::uint32_t>(dashes) + 1;
    return fail(Code::kExtraText, {begin, begin + 2}, "no comment begins with '--'",
                "begin a comment with #", Edit{{begin, begin + 2}, "#"});
  }
  if (const std::string_view line_of_it = statement_of_clause(token.text); !line_of_it.empty())
    return fail(Code::kExtraText, token.span,
                std::string(token.text) + " has no place in this line",
                "write " + upper_case(token.text) + " on the " + std::string(line_of_it) + " line");
  // IN is a clause of two statements.
  if ((is_reserved(token.text) && token.text != "IN") || is_word_of_reuse(token.text))
    return fail(Code::kExtraText, token.span, std::string(token.text) + " begins a line of its own",
                "begin a new line in front of it",
                Edit{{token.span.begin, token.span.begin}, "\n"});
  return fail(Code::kExtraText, s.rest(), std::string(kCause),
              !remedy.empty() ? std::string(remedy)
                              : "a line holds one statement; a comment begins with #");
}

bool LineReader::condition_ends(Scanner& s) {
  if (auto slip = behind_condition(s)) {
    diagnostics_.push_back(std::move(*slip));
    return false;
  }
  return line_ends(s, "join two conditions with && or ||, or remove it; a comment begins with #");
}

bool LineReader::is_foreign_word(const Token& word, std::string_view line, Code code) {
  const std::string_view remedy = remedy_of_foreign_word(word.text, line);
  return !remedy.empty() &&
         !fail(code, word.span, "unexpected '" + std::string(word.text) + "' in this line",
               std::string(remedy));
}

std::optional<syntax::Expression> LineReader::expression(Scanner& s) {
  return parse_expression(s, diagnostics_);
}

}  // namespace culprit
