#include "rule_json/spelling.h"

#include "language/scanner.h"

namespace culprit::rule_json {
namespace {

Span whole(std::string_view text) { return {0, static_cast<std::uint32_t>(text.size())}; }

bool is_one_line(std::string_view text) { return text.find('\n') == std::string_view::npos; }

// A template's parameter may be any; whether it stands in one is seen once all lines are there.
bool is_token(std::string_view text, Token::Kind kind) {
  const Token token = Scanner(text, whole(text), nullptr, Holes::kAllowed).next();
  const bool is_kind = token.kind == kind || (token.has_hole && kind != Token::Kind::kString);
  return is_one_line(text) && is_kind && token.span == whole(text);
}

syntax::Name read_name(std::string_view text) { return Scanner(text, whole(text)).next_name(); }

// `value` if it is written back as `text`. A text that begins with a quote is always a spelling, so
// that no value has two meanings.
Json value_or_spelling(const std::string& value, std::string_view text,
                       std::string_view rewritten) {
  const bool is_plain = !value.starts_with('"') && rewritten == text;
  return is_plain ? Json(value) : Json(text);
}

}  // namespace

std::string in_quotes(std::string_view value) {
  std::string out = "\"";
  for (const char c : value) {
    if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out + '"';
}

std::string spelled(std::string_view name) {
  const syntax::Name read = read_name(name);
  const bool is_bare =
      !name.empty() && is_one_line(name) && name.front() != '"' && read.span == whole(name);
  return is_bare ? std::string(name) : in_quotes(name);
}

Json text_to_json(std::string_view text) {
  const Token token = Scanner(text, whole(text)).next();
  const std::string value = std::get<std::string>(token.value());
  return value_or_spelling(value, text, in_quotes(value));
}

Json name_to_json(std::string_view text) {
  const std::string value = read_name(text).text;
  return value_or_spelling(value, text, spelled(value));
}

Json number_to_json(const std::string& text) {
  Json number = parse_json(text);
  return number.is_number() && to_line(number) == text ? number : Json(text);
}

bool is_word(std::string_view text) { return is_token(text, Token::Kind::kIdentifier); }

bool is_name(std::string_view text) {
  return !text.empty() && is_one_line(text) && read_name(text).span == whole(text);
}

bool is_text(std::string_view text) { return is_token(text, Token::Kind::kString); }

bool is_number(std::string_view text) { return is_token(text, Token::Kind::kNumber); }

bool is_duration(std::string_view text) { return is_token(text, Token::Kind::kDuration); }

}  // namespace culprit::rule_json
