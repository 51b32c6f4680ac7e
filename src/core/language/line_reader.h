// The pieces that statements are made of, read off one line.
//
// A reader that does not find its piece reports what it expected, at the place where it looked, and
// gives nothing; the statement is then given up, so each line has at most one diagnostic. `what`
// names the piece for the message. In the lines of a template a parameter may stand for any piece
// but the words of the language and the quotes of a text; the reader then gives any valid value.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

std::string upper_case(std::string_view word);

// A component's own name, or the full name of its node.
bool is_component_reference(std::string_view name);

// The types of other languages, which stand in front of a name there.
bool is_type_word(std::string_view word);

// How to write `name`, which is no full ROS name.
std::string remedy_of_ros_name(std::string_view name);

class LineReader {
 public:
  LineReader(const Source& source, std::vector<Diagnostic>& diagnostics)
      : source_(source), diagnostics_(diagnostics) {}

  std::optional<syntax::Name> identifier(Scanner& s, std::string_view what);
  // An identifier that is no word of the language.
  std::optional<syntax::Name> declared_name(Scanner& s, std::string_view what);
  // Anything without blanks, or a quoted text.
  std::optional<syntax::Name> name_or_text(Scanner& s, std::string_view what);
  // A component's name, or a node's full name.
  std::optional<syntax::Name> component_reference(Scanner& s);
  std::optional<syntax::Name> ros_name(Scanner& s, std::string_view what);
  // A quoted text, unescaped; its span has the quotes.
  std::optional<syntax::Name> text(Scanner& s, std::string_view what, std::string_view remedy);

  std::optional<Duration> duration(Scanner& s, std::string_view what);
  // "00:10", "EVERY 200ms" in place of a duration: reported.
  bool fail_foreign_duration(const Token& token, const Scanner& behind);
  std::optional<Duration> positive_duration(Scanner& s, std::string_view what);
  std::optional<syntax::Number> number(Scanner& s, std::string_view what, std::string remedy = "");
  std::optional<std::int64_t> whole_number(Scanner& s, std::string_view what);
  std::optional<double> signed_number(Scanner& s);
  std::optional<syntax::Expression> expression(Scanner& s);

  bool expect_word(Scanner& s, std::string_view word, std::string remedy = "");
  // Whether `name` is all of a name: not so in "front camera NODE", where NODE is one of the words
  // that may follow it. Any may if there are none. Takes nothing.
  bool is_one_word(const Scanner& s, const syntax::Name& name,
                   std::span<const std::string_view> followers = {});
  // "front.camera": reported.
  bool has_dot(const Scanner& s, const syntax::Name& name);
  bool expect_symbol(Scanner& s, std::string_view symbol, std::string remedy = "");
  // Does the line end here, except for a comment? `remedy` is for text that nothing is known about.
  bool line_ends(Scanner& s, std::string_view remedy = "");
  // The same behind a condition.
  bool condition_ends(Scanner& s);
  // A word of another tool that the `line` of that statement has in no form: reported.
  bool is_foreign_word(const Token& word, std::string_view line, Code code = Code::kSyntax);
  bool fail_comma(const Token& comma);
  // "0,5"
  bool is_in_number(const Token& comma) const;
  bool fail_comma_in_number(const Token& comma);

  // Complaints. All give false, for `return fail(...)`.
  bool fail(Code code, Span span, std::string cause, std::string remedy,
            std::optional<Edit> fix = {});
  bool fail_token(const Token& token, std::string_view expected, std::string remedy,
                  std::optional<Edit> fix = {});
  bool unexpected_clause(const Token& token, std::vector<std::string_view> known,
                         std::string remedy = "", Code code = Code::kSyntax);

  // The mistakes that follow from the first one of a line, which was reported.
  std::size_t complaints() const { return diagnostics_.size(); }
  // @pre there is a complaint
  std::uint32_t last_place() const { return diagnostics_.back().span.begin; }
  void forget_since(std::size_t complaints) {
    diagnostics_.erase(diagnostics_.begin() + static_cast<std::ptrdiff_t>(complaints),
                       diagnostics_.end());
  }

 private:
  bool has_digit(std::uint32_t at) const;

  // The replacement for a separator that is removed, so that no two words become one.
  std::string blank_for(const Token& separator) const;

  const Source& source_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace culprit
