#include "language/reuse/statements.h"

#include <algorithm>

namespace culprit {
namespace {

using syntax::Name;

constexpr const char* kHowToUse =
    "write USE name, with its arguments in parentheses: USE driver(lidar, /scan, 10)";

std::optional<syntax::TemplateParameter> parameter(LineReader& read, Scanner& s) {
  auto name = read.declared_name(s, "a parameter's name");
  if (!name) return std::nullopt;
  if (is_type_word(name->text) && s.peek().kind == Token::Kind::kIdentifier) {
    read.fail(Code::kSyntax, name->span, "a parameter has no type", "remove '" + name->text + "'",
              Edit{{name->span.begin, s.peek().span.begin}, ""});
    return std::nullopt;
  }
  syntax::TemplateParameter out{std::move(*name), {}};
  if (s.peek().is(":")) {
    read.fail(Code::kSyntax, s.peek().span, "expected '=', not ':'",
              "write '=' in front of the usual value", Edit{s.peek().span, " ="});
    return std::nullopt;
  }
  const Token& next = s.peek();
  const bool is_value = next.kind == Token::Kind::kNumber || next.kind == Token::Kind::kDuration ||
                        next.kind == Token::Kind::kString || next.is("/");
  if (is_value) {
    read.fail(Code::kSyntax, next.span, "'=' is missing in front of the usual value",
              "write " + out.name.text + " = " + s.ahead().next_name().text,
              Edit{{next.span.begin, next.span.begin}, "= "});
    return std::nullopt;
  }
  if (!next.is("=")) return out;
  s.next();
  out.usual = read.name_or_text(s, "what '" + out.name.text + "' is if a USE does not say");
  return out.usual ? std::optional(std::move(out)) : std::nullopt;
}

bool add_parameter(LineReader& read, syntax::TemplateParameter parameter,
                   std::vector<syntax::TemplateParameter>& all) {
  const Name& name = parameter.name;
  const bool is_known = std::any_of(
      all.begin(), all.end(), [&](const auto& known) { return known.name.text == name.text; });
  if (is_known)
    return read.fail(Code::kDuplicateName, name.span,
                     "this template has a parameter '" + name.text + "' already",
                     "give this one another name");
  if (!parameter.usual && !all.empty() && all.back().usual)
    return read.fail(Code::kSyntax, name.span,
                     "'" + name.text + "' has no usual value, and one before it has",
                     "put the parameters that a USE has to give in front");
  all.push_back(std::move(parameter));
  return true;
}

// "name=camera": reported.
bool is_named(LineReader& read, const Name& argument) {
  const auto sign = argument.text.find('=');
  const bool is_quoted = argument.span.end - argument.span.begin > argument.text.size();
  if (sign == std::string::npos || is_quoted ||
      !is_component_reference(argument.text.substr(0, sign)))
    return false;
  const std::string value = argument.text.substr(sign + 1);
  return !read.fail(
      Code::kTemplateArguments, argument.span, "arguments have no names",
      "write only " + (value.empty() ? "the value" : value) + ", in the order of the template",
      value.empty() ? std::nullopt : std::optional(Edit{argument.span, value}));
}

// Or an argument without a ',' in front, which is reported.
bool comma(LineReader& read, Scanner& s) {
  const Token& next = s.peek();
  const bool is_argument =
      next.kind == Token::Kind::kIdentifier || next.kind == Token::Kind::kNumber ||
      next.kind == Token::Kind::kDuration || next.kind == Token::Kind::kString || next.is("/");
  if (!is_argument) return read.expect_symbol(s, ",");
  const Name argument = s.ahead().next_name();
  return read.fail(Code::kSyntax, argument.span, "expected ',', not '" + argument.text + "'",
                   "write a ',' in front of it", Edit{{next.span.begin, next.span.begin}, ", "});
}

// "(a, b)": `read_one` takes one of them, and gives false if it cannot.
template <class ReadOne>
bool list(LineReader& read, Scanner& s, ReadOne read_one) {
  if (!s.peek().is("(")) return true;
  s.next();
  for (bool is_first = true; !s.peek().is(")"); is_first = false) {
    if (!is_first && !comma(read, s)) return false;
    if (!read_one()) return false;
    if (s.at_end()) return read.expect_symbol(s, ")");
  }
  s.next();
  return true;
}

}  // namespace

std::optional<syntax::Include> read_include(LineReader& read, Scanner& s, Span line) {
  auto file = read.text(s, "the file", "write it in quotes: INCLUDE \"packs/nav2.rules\"");
  if (!file) return std::nullopt;
  const Span span{line.begin, file->span.end};
  return syntax::Include{std::move(*file), span};
}

std::optional<syntax::Template> read_template(LineReader& read, Scanner& s) {
  auto name = read.declared_name(s, "the template's name");
  if (!name) return std::nullopt;
  syntax::Template out;
  out.name = std::move(*name);
  const bool is_good = list(read, s, [&] {
    auto one = parameter(read, s);
    return one && add_parameter(read, std::move(*one), out.parameters);
  });
  return is_good ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<syntax::Use> read_use(LineReader& read, Scanner& s, Span line) {
  auto pattern = read.identifier(s, "the name of a template");
  if (!pattern) return std::nullopt;
  syntax::Use use{std::move(*pattern), {}, {}, {line.begin, s.taken()}};
  const bool is_good = list(read, s, [&] {
    auto argument = read.name_or_text(s, "an argument");
    if (argument && is_named(read, *argument)) return false;
    if (argument) use.arguments.push_back(std::move(*argument));
    return argument.has_value();
  });
  if (!is_good) return std::nullopt;
  use.span.end = s.taken();
  if (s.at_end()) return use;
  if (s.peek().text != "IN") {
    read.fail(Code::kExtraText, s.rest(), "this text does not belong to the line", kHowToUse);
    return std::nullopt;
  }
  s.next();
  use.in = read.ros_name(s, "the namespace, as /robot1");
  if (!use.in) return std::nullopt;
  use.span.end = use.in->span.end;
  return use;
}

bool check_holes(LineReader& read, std::string_view text, std::span<const Lexeme> line,
                 const syntax::Template& pattern) {
  std::vector<std::string_view> known;
  for (const auto& parameter : pattern.parameters) known.push_back(parameter.name.text);
  bool are_good = true;
  for (const Lexeme& lexeme : line) {
    const bool is_quoted = text[lexeme.span.begin] == '"';
    for (std::uint32_t at = lexeme.span.begin; at < lexeme.span.end; ++at) {
      const auto length =
          static_cast<std::uint32_t>(hole_length(text.substr(at, lexeme.span.end - at)));
      if (length == 0) continue;
      const std::string_view name = text.substr(at + 1, length - 2);
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      const std::string near = closest(name, known);
      if (is_quoted && near.empty()) continue;
      std::string all;
      for (const std::string_view each : known)
        all += (all.empty() ? "its parameters are " : ", ") + std::string(each);
      const Span inside{at + 1, at + length - 1};
      are_good = read.fail(
          Code::kUnknownParameter, {at, at + length},
          "template '" + pattern.name.text + "' has no parameter '" + std::string(name) + "'",
          !near.empty()   ? "did you mean '" + near + "'?"
          : known.empty() ? "it has none"
                          : all,
          replacement(inside, near));
    }
  }
  return are_good;
}

}  // namespace culprit
