#include "language/scanner.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>

namespace culprit {
namespace {

constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A table, because most characters of a file are looked at here.
constexpr auto kIsNameCharacter = [] {
  std::array<bool, 256> table{};
  for (int c = 0; c < 128; ++c)
    table[static_cast<std::size_t>(c)] =
        is_letter(static_cast<char>(c)) || is_digit(static_cast<char>(c));
  return table;
}();
bool is_name_character(char c) { return kIsNameCharacter[static_cast<unsigned char>(c)]; }

// Where the name ends that `text` may begin with.
std::size_t name_length(std::string_view text) {
  return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_name_character) -
                                  text.begin());
}

Lexeme::Kind lexeme_kind(Token::Kind kind) {
  if (kind == Token::Kind::kIdentifier) return Lexeme::Kind::kWord;
  return kind == Token::Kind::kSymbol ? Lexeme::Kind::kSymbol : Lexeme::Kind::kLiteral;
}

// The length of the symbol that `text`, one or two characters, begins with; 0 if with none.
std::uint32_t symbol_length(std::string_view text) {
  const char first = text[0];
  const char second = text.size() == 2 ? text[1] : '\0';
  switch (first) {
    case '<':
    case '>':
    case '=':
    case '!':
      return second == '=' ? 2 : 1;
    case '&':
    case '|':
    case '.':
      return second == first ? 2 : 0;
    default:
      return std::string_view("-+*/%()?:,").find(first) != std::string_view::npos ? 1 : 0;
  }
}

// @pre the scanner has found its escapes to be known ones
std::string unescaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '\\') {
      c = text[++i];
      if (c == 'n') c = '\n';
      if (c == 't') c = '\t';
    }
    out += c;
  }
  return out;
}

// `rest`: of the line, from the quote on.
Complaint unclosed(std::uint32_t begin, std::string_view rest) {
  while (rest.size() > 1 && is_blank(rest.back())) rest.remove_suffix(1);
  const auto end = begin + static_cast<std::uint32_t>(rest.size());
  return {"this string has no closing '\"'", Edit{{end, end}, "\""},
          "write a '\"' where the text ends"};
}

// Quotes as keyboards, word processors and web pages change them.
constexpr std::array<std::string_view, 9> kForeignQuotes = {
    "'", "`", "\u201c", "\u201d", "\u201e", "\u2018", "\u2019", "\u00ab", "\u00bb"};

std::size_t foreign_quote_length(std::string_view text) {
  for (const std::string_view quote : kForeignQuotes) {
    if (text.starts_with(quote)) return quote.size();
  }
  return 0;
}

// The same text in the quotes that the language has; nothing if it does not end, or needs escapes.
std::optional<Edit> in_double_quotes(std::uint32_t begin, std::string_view rest) {
  const std::size_t open = foreign_quote_length(rest);
  std::size_t close = open;
  while (close < rest.size() && foreign_quote_length(rest.substr(close)) == 0) ++close;
  if (close == rest.size()) return std::nullopt;
  const std::string_view inside = rest.substr(open, close - open);
  if (inside.find_first_of("\"\\") != std::string_view::npos) return std::nullopt;
  const std::size_t end = close + foreign_quote_length(rest.substr(close));
  return Edit{{begin, begin + static_cast<std::uint32_t>(end)}, "\"" + std::string(inside) + "\""};
}

struct LookAlike {
  std::string_view written, meant;
};
constexpr std::array<LookAlike, 20> kLookAlikes = {
    {{"&lt;", "<"},  // as XML writes them
     {"&gt;", ">"},    {"&amp;&amp;", "&&"}, {"\u2265", ">="}, {"\u2264", "<="}, {"\u2260", "!="},
     {"\u2212", "-"},  {"\u2013", "-"},      {"\u2014", "-"},  {"\u00d7", "*"},  {"\u00b7", "*"},
     {"\u00f7", "/"},  {"\u2227", "&&"},     {"\u2228", "||"}, {"\u00ac", "!"},  {"\u2192", ""},
     {"\u2026", ".."}, {"~=", "!="},         {"&", "&&"},      {"|", "||"}}};

// Blanks that no keyboard shows: no-break space and the like, and those without a width.
constexpr std::array<std::string_view, 8> kForeignBlanks = {"\u00a0", "\u2002", "\u2003", "\u2009",
                                                            "\u202f", "\u3000", "\u200b", "\ufeff"};

// Whether `character`, which has all its continuation bytes, is UTF-8.
bool is_utf8(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character[0]);
  const std::size_t expected = lead < 0x80   ? 1
                               : lead < 0xc2 ? 0
                               : lead < 0xe0 ? 2
                               : lead < 0xf0 ? 3
                               : lead < 0xf5 ? 4
                                             : 0;
  return character.size() == expected;
}

// "|heat|" -> "heat"; empty: `rest` begins with something else.
std::string between_bars(std::string_view rest) {
  const auto end = rest.find_first_of("| \t&<>=\"\n", 1);
  const bool is_so = rest[0] == '|' && end != std::string_view::npos && end > 1 && rest[end] == '|';
  return is_so ? std::string(rest.substr(1, end - 1)) : "";
}

Complaint meaningless(Span span, std::string_view rest) {
  const std::string_view character = rest.substr(0, span.end - span.begin);
  const auto first = static_cast<unsigned char>(rest[0]);
  if (first < 0x20 || first == 0x7f)
    return {"a control character has no place in a rule file", Edit{span, ""}, "remove it"};
  if (!is_utf8(character))
    return {"this character is not UTF-8", std::nullopt, "save the file as UTF-8"};
  const std::string cause = "'" + std::string(character) + "' means nothing here";
  if (foreign_quote_length(rest) > 0 && first >= 0x80)
    return {"'" + std::string(character) + "' is a typographic quote",
            in_double_quotes(span.begin, rest), "write the straight quote of the keyboard: \""};
  if (foreign_quote_length(rest) > 0)
    return {cause, in_double_quotes(span.begin, rest), "a text stands in double quotes"};
  for (const std::string_view blank : kForeignBlanks) {
    if (character == blank)
      return {"this character looks like a blank, and is another one", Edit{span, " "},
              "write an ordinary blank"};
  }
  if (const std::string inside = between_bars(rest); !inside.empty())
    return {"'|' is no operator",
            Edit{{span.begin, span.begin + static_cast<std::uint32_t>(inside.size()) + 2},
                 "abs(" + inside + ")"},
            "write abs(" + inside + ")"};
  for (const auto& [written, meant] : kLookAlikes) {
    if (!rest.starts_with(written)) continue;
    if (meant.empty()) break;
    const auto end = span.begin + static_cast<std::uint32_t>(written.size());
    return {"'" + std::string(written) + "' is no operator",
            Edit{{span.begin, end}, std::string(meant)}, "write " + std::string(meant)};
  }
  if (character == "\u00b0") return {cause, std::nullopt, "write the number without its unit"};
  if (first >= 0x80)
    return {"'" + std::string(character) + "' stands only in texts and comments", std::nullopt,
            "names are made of the letters a to z and A to Z, digits and '_'"};
  switch (first) {
    case '{':
    case '}':
      if (hole_length(rest) > 0)
        return {cause + "; a parameter in braces stands for something in a TEMPLATE only"};
      return {cause, Edit{span, ""}, "remove it: a rule ends where the next one begins"};
    case ';':
      return {cause, Edit{span, ""},
              trimmed(rest.substr(1)).empty()
                  ? "remove it: a statement ends with its line"
                  : "remove it: a statement ends with its line; a comment begins with #"};
    case '[':
    case ']':
      return {cause, std::nullopt, "write parentheses: ( and )"};
    case '$':
      return {cause, std::nullopt, "in a TEMPLATE, a parameter stands in braces, as in {name}"};
    case '^':
      return {cause, std::nullopt, "write pow(base, exponent)"};
    case '.':
      return {cause, std::nullopt, "write alive(camera) for a node, and SIGNAL for a field"};
    case '\\':
      return {cause, Edit{span, ""}, "remove it: a statement is one line"};
    default:
      return {cause, std::nullopt, "remove it; a comment begins with #"};
  }
}

// `text`: digits, and letters that are no unit.
// "1m30s", "1h5min" -> the same in one unit; empty: it is nothing of the kind.
std::string in_one_unit(std::string_view text) {
  Duration sum{};
  while (!text.empty()) {
    const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
    const auto end = std::min(text.find_first_of("0123456789", digits), text.size());
    std::string part(text.substr(0, end));
    if (part.ends_with('m')) part += "in";
    constexpr std::size_t kMostDigits = 6;
    const auto read = parse_duration(part);
    if (!read || digits > kMostDigits) return "";
    sum += *read;
    text.remove_prefix(end);
  }
  return to_string(sum);
}

Complaint not_a_number(Span span, std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && (is_digit(text[end]) || text[end] == '.')) ++end;
  const std::string number(text.substr(0, end));
  if (text.starts_with("0x") || text.starts_with("0X"))
    return {"'" + std::string(text) + "' is no number of the language", std::nullopt,
            "write it as a decimal number"};
  if (text.find('_') != std::string_view::npos &&
      text.find_first_not_of("0123456789_") == std::string_view::npos) {
    std::string plain(text);
    std::erase(plain, '_');
    return {"a number has no '_' in it", Edit{span, plain}, "write " + plain};
  }
  const std::string_view letters = text.substr(end);
  const std::string cause = "'" + std::string(text) + "' is neither a number nor a duration";
  if (letters == "m")
    return {cause, std::nullopt, "write " + number + "min for minutes, or " + number + "ms"};
  if (letters == "d" && number.size() < 4 && number.find('.') == std::string::npos) {
    const std::string hours = std::to_string(std::atoi(number.c_str()) * 24) + "h";
    return {cause, Edit{span, hours}, "write " + hours};
  }
  if (const std::string whole = in_one_unit(text); !whole.empty())
    return {"a duration has one unit", Edit{span, whole}, "write " + whole};
  const std::string_view unit = duration_unit(letters);
  if (unit.empty()) return {cause};
  const std::string meant = number + std::string(unit);
  return {cause, Edit{span, meant}, "write " + meant};
}

std::string lower_case(std::string_view word) {
  std::string text(word);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

std::string_view duration_unit(std::string_view word) {
  struct Unit {
    std::string_view unit;
    std::array<std::string_view, 6> words;
  };
  static constexpr std::array<Unit, 6> kUnits = {
      {{"s", {"s", "sec", "secs", "second", "seconds"}},
       {"ms", {"ms", "msec", "msecs", "millis", "millisecond", "milliseconds"}},
       {"min", {"min", "mins", "minute", "minutes"}},
       {"h", {"h", "hr", "hrs", "hour", "hours"}},
       {"us", {"us", "usec", "usecs", "micros", "microsecond", "microseconds"}},
       {"ns", {"ns", "nsec", "nsecs", "nanos", "nanosecond", "nanoseconds"}}}};
  if (word.empty()) return "";
  const std::string lower = lower_case(word);
  for (const auto& [unit, words] : kUnits) {
    if (std::find(words.begin(), words.end(), lower) != words.end()) return unit;
  }
  return "";
}

bool is_hertz(std::string_view word) {
  const std::string lower = lower_case(word);
  return lower == "hz" || lower == "hertz" || lower == "fps";
}

Complaint complaint_about(const Token& bad) {
  const auto rest = std::get<std::string_view>(bad.literal);
  switch (bad.flaw) {
    case Token::Flaw::kLongName:
      return {"this name is longer than 255 characters", std::nullopt, "shorten it"};
    case Token::Flaw::kBrace:
      return {"a parameter stands in braces, as in {name}", std::nullopt,
              "write one brace on each side of it"};
    case Token::Flaw::kNumber:
      return not_a_number(bad.span, rest.substr(0, bad.span.end - bad.span.begin));
    case Token::Flaw::kWholeNumber:
      return {"this whole number does not fit in 64 bits", std::nullopt,
              "write it with a decimal point"};
    case Token::Flaw::kRange:
      return {"this number is out of range", std::nullopt, "write one below 1.7e308"};
    case Token::Flaw::kEscape:
      return {"unknown escape in a string; known: \\\" \\\\ \\n \\t"};
    case Token::Flaw::kUnclosed:
      return unclosed(bad.span.begin, rest);
    case Token::Flaw::kMeaningless:
      return meaningless(bad.span, rest);
    case Token::Flaw::kNone:
      break;
  }
  return {};
}

syntax::Literal Token::value() const {
  const auto owned = [](auto borrowed) -> syntax::Literal {
    if constexpr (std::is_same_v<decltype(borrowed), std::string_view>)
      return unescaped(borrowed);
    else
      return borrowed;
  };
  return std::visit(owned, literal);
}

std::string_view trimmed(std::string_view text) {
  text = unindented(text);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::size_t hole_length(std::string_view text) {
  if (text.size() < 3 || text[0] != '{' || !is_letter(text[1])) return 0;
  std::size_t end = 2;
  while (end < text.size() && is_name_character(text[end])) ++end;
  return end < text.size() && text[end] == '}' ? end + 1 : 0;
}

bool has_hole(std::string_view text) {
  for (auto open = text.find('{'); open != std::string_view::npos; open = text.find('{', open + 1))
    if (hole_length(text.substr(open)) > 0) return true;
  return false;
}

bool Scanner::is_comment(std::uint32_t at) const {
  return text_[at] == '#' || (text_[at] == '/' && at + 1 < end_ && text_[at + 1] == '/');
}

// The next character that counts, or end_.
std::uint32_t Scanner::skip_blanks() const {
  std::uint32_t at = at_;
  while (at < end_ && is_blank(text_[at])) ++at;
  return at < end_ && is_comment(at) ? end_ : at;
}

bool Scanner::at_end() const { return skip_blanks() == end_; }
std::uint32_t Scanner::position() const { return skip_blanks(); }

std::string_view Scanner::next_letters() const {
  const std::uint32_t begin = skip_blanks();
  std::uint32_t end = begin;
  while (end < end_ && is_letter(text_[end])) ++end;
  return text_.substr(begin, end - begin);
}

Span Scanner::rest() const {
  const std::uint32_t begin = skip_blanks();
  std::uint32_t end = begin;
  for (std::uint32_t at = begin; at < end_ && !is_comment(at); ++at) {
    if (!is_blank(text_[at])) end = at + 1;
  }
  return {begin, end};
}

Token Scanner::next() {
  const Token token = peeked_ ? *peeked_ : scan();
  peeked_.reset();
  at_ = token.span.end;
  if (token.kind != Token::Kind::kEnd) enter(lexeme_kind(token.kind), token.span);
  return token;
}

const Token& Scanner::peek() const {
  if (!peeked_) peeked_ = scan();
  return *peeked_;
}

Token Scanner::scan() const {
  const std::uint32_t at = skip_blanks();
  if (at == end_) return {Token::Kind::kEnd, false, {at, at}, {}, {}};
  const char c = text_[at];
  const bool fraction = c == '.' && at + 1 < end_ && is_digit(text_[at + 1]);
  if (is_digit(c) || fraction) return number(at);
  if (is_letter(c)) return identifier(at);
  if (c == '{' && allows_holes()) return with_holes(at);
  if (c == '"') return quoted(at);
  return symbol(at);
}

Token Scanner::bad(Span span, Token::Flaw flaw) const {
  return {Token::Kind::kBad, false, span, {}, text_.substr(span.begin, end_ - span.begin), flaw};
}

Token Scanner::identifier(std::uint32_t at) const {
  const std::string_view text(text_.data() + at, name_length({text_.data() + at, end_ - at}));
  const std::uint32_t end = at + static_cast<std::uint32_t>(text.size());
  if (end < end_ && text_[end] == '{' && allows_holes()) return with_holes(at);
  if (text.size() > kMaxName) return bad({at, end}, Token::Flaw::kLongName);
  Token token{Token::Kind::kIdentifier, false, {at, end}, text, {}};
  // Keywords of expressions; elsewhere the text serves.
  const bool may_be_literal = text.front() == 't' || text.front() == 'f';
  if (may_be_literal && (text == "true" || text == "false")) token.literal = text == "true";
  return token;
}

// Letters, digits and holes, in any order.
Token Scanner::with_holes(std::uint32_t at) const {
  std::uint32_t end = at;
  while (end < end_) {
    const std::size_t hole = hole_length(text_.substr(end, end_ - end));
    if (hole == 0 && !is_name_character(text_[end])) break;
    end += hole > 0 ? static_cast<std::uint32_t>(hole) : 1;
  }
  if (end < end_ && text_[end] == '{') return bad({end, end + 1}, Token::Flaw::kBrace);
  if (end - at > kMaxName) return bad({at, end}, Token::Flaw::kLongName);
  return {Token::Kind::kIdentifier, true, {at, end}, text_.substr(at, end - at), {}};
}

Token Scanner::number(std::uint32_t at) const {
  std::uint32_t end = at;
  const auto digits = [&] {
    while (end < end_ && is_digit(text_[end])) ++end;
  };
  bool whole = true;
  digits();
  // "0..1" is a range, not a number with a point.
  if (end < end_ && text_[end] == '.' && !(end + 1 < end_ && text_[end + 1] == '.')) {
    whole = false;
    ++end;
    digits();
  }
  if (end < end_ && (text_[end] == 'e' || text_[end] == 'E')) {
    std::uint32_t exponent = end + 1;
    if (exponent < end_ && (text_[exponent] == '+' || text_[exponent] == '-')) ++exponent;
    if (exponent < end_ && is_digit(text_[exponent])) {
      whole = false;
      end = exponent;
      digits();
    }
  }
  const std::uint32_t number_end = end;
  while (end < end_ && is_name_character(text_[end])) ++end;

  const std::string_view text = text_.substr(at, end - at);
  if (end > number_end) {
    if (const auto duration = parse_duration(text))
      return {Token::Kind::kDuration, false, {at, end}, {}, *duration};
    return bad({at, end}, Token::Flaw::kNumber);
  }
  const char* last = text_.data() + number_end;
  if (std::int64_t i = 0; whole) {
    if (std::from_chars(text_.data() + at, last, i).ec == std::errc()) {
      return {Token::Kind::kNumber, false, {at, end}, {}, i};
    }
    return bad({at, end}, Token::Flaw::kWholeNumber);
  }
  double d = 0;
  if (std::from_chars(text_.data() + at, last, d).ec != std::errc() || !std::isfinite(d)) {
    return bad({at, end}, Token::Flaw::kRange);
  }
  return {Token::Kind::kNumber, false, {at, end}, {}, d};
}

Token Scanner::quoted(std::uint32_t at) const {
  for (std::uint32_t i = at + 1; i < end_; ++i) {
    if (text_[i] == '"')
      return {Token::Kind::kString, false, {at, i + 1}, {}, text_.substr(at + 1, i - at - 1)};
    if (text_[i] != '\\' || i + 1 == end_) continue;
    if (std::string_view("nt\"\\").find(text_[++i]) == std::string_view::npos)
      return bad({i - 1, i + 1}, Token::Flaw::kEscape);
  }
  return bad({at, end_}, Token::Flaw::kUnclosed);
}

Token Scanner::symbol(std::uint32_t at) const {
  if (const std::uint32_t length = symbol_length(text_.substr(at, std::min(2u, end_ - at)))) {
    return {Token::Kind::kSymbol, false, {at, at + length}, text_.substr(at, length), {}};
  }
  std::uint32_t end = at + 1;
  while (end < end_ && (static_cast<unsigned char>(text_[end]) & 0xC0) == 0x80)
    ++end;  // one whole character
  return bad({at, end}, Token::Flaw::kMeaningless);
}

bool Scanner::take(char symbol) {
  const std::uint32_t at = skip_blanks();
  if (at == end_ || text_[at] != symbol) return false;
  peeked_.reset();
  at_ = at + 1;
  enter(Lexeme::Kind::kSymbol, {at, at_});
  return true;
}

syntax::Name Scanner::next_name() {
  peeked_.reset();
  const std::uint32_t begin = skip_blanks();
  if (begin < end_ && text_[begin] == '"') {
    Token token = quoted(begin);
    if (token.kind == Token::Kind::kString) {
      at_ = token.span.end;
      enter(Lexeme::Kind::kName, token.span);
      return {std::get<std::string>(token.value()), token.span};
    }
  }
  std::uint32_t end = begin;
  while (end < end_ && !is_blank(text_[end]) && text_[end] != ',' && text_[end] != ')' &&
         text_[end] != '(' && !is_comment(end)) {
    ++end;
  }
  at_ = end;
  enter(Lexeme::Kind::kName, {begin, end});
  return {std::string(text_.substr(begin, end - begin)), {begin, end}};
}

}  // namespace culprit
