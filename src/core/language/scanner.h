// Source text -> tokens, one line at a time and on demand.
//
// The language is line-oriented, so a scanner stands in one line and never leaves it: a mistake
// cannot spread to the next line. The meaning of a '/' or a '.' depends on the place (division or
// topic name, decimal point or parameter name), so the parser asks for the kind of token that it
// can use there. Comments (# and //) and line ends look the same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// It borrows its text: it is valid as long as what was scanned.
struct Token {
  enum class Kind : std::uint8_t {
    kEnd,         // of the line
    kIdentifier,  // [A-Za-z_][A-Za-z0-9_]*
    kNumber,      // literal is an int64 or a double
    kDuration,
    kString,  // literal is what stands between the quotes, which value() unescapes
    kSymbol,  // an operator or a parenthesis; text says which
    kBad      // flaw says what is wrong with it, and complaint_about() in words
  };
  enum class Flaw : std::uint8_t {
    kNone,
    kLongName,     // more than kMaxName characters
    kBrace,        // a '{' that begins no parameter
    kNumber,       // letters behind it that are no unit
    kWholeNumber,  // does not fit in 64 bits
    kRange,        // nor this one in a double
    kEscape,       // a backslash in a text, and what may not follow it
    kUnclosed,     // a text without its second '"'
    kMeaningless   // a character that begins nothing
  };
  Kind kind = Kind::kEnd;
  // A kIdentifier with a template's parameter in it: may become any kind of token.
  bool has_hole = false;
  Span span;
  std::string_view text;  // of an identifier or a symbol; else empty
  // Of a kBad: what stands from there to the end of the line.
  std::variant<bool, std::int64_t, double, std::string_view, Duration> literal;
  Flaw flaw = Flaw::kNone;

  bool is(std::string_view symbol) const { return kind == Kind::kSymbol && text == symbol; }
  // The value of a literal, true or false.
  syntax::Literal value() const;
};
// Tokens come and go for every word of a file, so they own nothing.
static_assert(std::is_trivially_copyable_v<Token>);

struct Complaint {
  std::string cause;
  std::optional<Edit> fix = std::nullopt;  // that makes the token a good one
  std::string remedy = "";                 // empty where it depends on the place
};
// @pre it is a kBad
Complaint complaint_about(const Token& bad);

// The unit of the language that people mean by `word`, as "s" by "seconds"; empty if none.
std::string_view duration_unit(std::string_view word);
// Whether it names hertz, in which rates are counted without a unit.
bool is_hertz(std::string_view word);

// A piece of a line as its reader took it, for those who care how the text was written.
struct Lexeme {
  enum class Kind : std::uint8_t {
    kWord,     // an identifier: a word of the language or a name of an expression
    kName,     // taken by next_name
    kLiteral,  // a number, a duration or a text
    kSymbol
  };
  Kind kind = Kind::kWord;
  Span span;
};

// Whether "{parameter}" may stand in the place of characters: in the lines of a template.
enum class Holes : std::uint8_t { kNone, kAllowed };

// The "{parameter}" that `text` begins with, with its braces; 0: it begins with none.
std::size_t hole_length(std::string_view text);
// Whether one is in it.
bool has_hole(std::string_view text);

class Scanner {
 public:
  // The longest name that is accepted, as in DDS (topic names are string<255>).
  static constexpr std::size_t kMaxName = 255;

  // Each token that is taken off the line is also appended to `record`, if there is one.
  Scanner(std::string_view text, Span line, std::vector<Lexeme>* record = nullptr,
          Holes holes = Holes::kNone)
      : text_(text), at_(line.begin), end_(line.end), record_(record), holes_(holes) {}

  // The next token of an expression or a clause.
  Token next();
  // The same without taking it. Valid until one is taken.
  const Token& peek() const;

  // The next run of non-blank characters up to a comment, a comma or a closing parenthesis: a
  // topic, node, parameter or mode name. A quoted string is taken as a name too. Empty at the end
  // of the line.
  syntax::Name next_name();

  // For a look at what follows: what is taken off it is not recorded.
  Scanner ahead() const {
    Scanner copy = *this;
    copy.record_ = nullptr;
    return copy;
  }

  // Takes `symbol`, one character that no expression has, as a brace is. False: another one is next.
  bool take(char symbol);

  bool allows_holes() const { return holes_ == Holes::kAllowed; }
  bool at_end() const;
  // The word of letters that begins the rest of the line; empty if none does.
  std::string_view next_letters() const;
  // A part of the whole text; shorter where the text ends.
  std::string_view text(Span span) const {
    return span.begin >= text_.size() ? "" : text_.substr(span.begin, span.end - span.begin);
  }
  // Where what was taken last ends.
  std::uint32_t taken() const { return at_; }
  // Where the next token begins.
  std::uint32_t position() const;
  // From the next token to the end of the line's text, comment and trailing blanks left out.
  Span rest() const;

 private:
  Token scan() const;
  std::uint32_t skip_blanks() const;
  bool is_comment(std::uint32_t at) const;
  Token number(std::uint32_t at) const;
  Token quoted(std::uint32_t at) const;
  Token identifier(std::uint32_t at) const;
  Token with_holes(std::uint32_t at) const;
  Token symbol(std::uint32_t at) const;
  Token bad(Span span, Token::Flaw flaw) const;
  void enter(Lexeme::Kind kind, Span span) {
    if (record_ != nullptr) record_->push_back({kind, span});
  }

  std::string_view text_;
  std::uint32_t at_;
  std::uint32_t end_;
  std::vector<Lexeme>* record_;
  Holes holes_;
  mutable std::optional<Token> peeked_;
};

// Is it white space between the tokens of a line?
inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}
// `text` without the blanks that it begins with.
inline std::string_view unindented(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  return text;
}
// `text` without what it begins and ends with of that.
std::string_view trimmed(std::string_view text);

}  // namespace culprit
