#include "language/request_text.h"

#include <cctype>

namespace culprit {
namespace {

// Reads YAML from left to right and keeps what is open.
class RequestText {
 public:
  explicit RequestText(std::string_view text) : text_(text) {}

  std::optional<RequestFlaw> flaw() {
    for (at_ = 0; at_ < text_.size() && is_judged_ && !flaw_; ++at_) take(text_[at_]);
    if (flaw_ || !is_judged_) return flaw_;
    if (!open_.empty())
      return RequestFlaw{
          "a '" + std::string(1, opener_of(open_.back())) + "' is not closed in this request",
          "write the missing '" + std::string(1, open_.back()) + "'"};
    if (has_content_ && !has_field_) return no_field();
    return std::nullopt;
  }

 private:
  void take(char c) {
    const bool is_in_flow = !open_.empty();
    const bool was_quoted = is_quoted_;
    if (c == '\n') begins_value_ = true;
    if (std::isspace(static_cast<unsigned char>(c)) != 0) return;
    is_quoted_ = false;
    if (c == '#' && (at_ == 0 || is_blank(at_ - 1))) return skip_comment();
    if (c != '{' && c != '}') has_content_ = true;
    if (begins_value_ && (c == '"' || c == '\'')) return quoted(c);
    if ((begins_value_ || is_in_flow) && (c == '{' || c == '[')) return open(c);
    if (is_in_flow && (c == '}' || c == ']')) return close(c);
    if (!is_in_flow && is_stray(c)) return stray(c);
    const bool ends_key =
        c == ':' && (is_blank(at_ + 1) || (is_in_flow && (was_quoted || is_sign(at_ + 1))));
    has_field_ = has_field_ || ends_key;
    // Block texts, anchors and tags are left to a parser.
    if (begins_value_ && std::string_view("|>&*!?").find(c) != std::string_view::npos)
      is_judged_ = false;
    const bool is_item = c == '-' && begins_value_ && is_blank(at_ + 1);
    begins_value_ = ends_key || is_item || (is_in_flow && c == ',');
  }

  // Behind the end, too.
  bool is_blank(std::size_t at) const {
    return at >= text_.size() || std::isspace(static_cast<unsigned char>(text_[at])) != 0;
  }
  bool is_sign(std::size_t at) const {
    return std::string_view(",[]{}").find(text_[at]) != std::string_view::npos;
  }

  static char opener_of(char closer) { return closer == '}' ? '{' : '['; }

  void open(char c) {
    open_ += c == '{' ? '}' : ']';
    begins_value_ = true;
  }

  void close(char c) {
    if (open_.back() != c)
      flaw_ = {"'" + std::string(1, c) + "' stands in this request where '" +
                   std::string(1, open_.back()) + "' is missing",
               "close each bracket before the one around it"};
    open_.pop_back();
    begins_value_ = false;
  }

  // The last sign of a request that opens none of its kind; elsewhere a text may hold it.
  bool is_stray(char c) const {
    return (c == '}' || c == ']') && at_ + 1 == text_.size() &&
           text_.find(opener_of(c)) == std::string_view::npos;
  }
  void stray(char c) {
    flaw_ = {"'" + std::string(1, c) + "' closes nothing in this request",
             "remove it, or write '" + std::string(1, opener_of(c)) + "' in front"};
  }

  void quoted(char quote) {
    const auto is_escaped = [&](std::size_t at) {
      return quote == '"' ? text_[at] == '\\' : text_.substr(at, 2) == "''";
    };
    std::size_t end = at_ + 1;
    while (end < text_.size() && (text_[end] != quote || is_escaped(end)))
      end += is_escaped(end) ? 2 : 1;
    if (end >= text_.size())
      flaw_ = {"a quote is not closed in this request",
               "write the missing " + std::string(1, quote)};
    at_ = end;
    is_quoted_ = true;
    begins_value_ = false;
  }

  void skip_comment() {
    while (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
  }

  std::optional<RequestFlaw> no_field() const {
    const std::string_view words = text_.substr(text_.find_first_not_of(" \t\n{"));
    if (words.starts_with("null") || words.starts_with('~')) return std::nullopt;
    const auto sign = words.find_first_of(":=");
    const bool is_field = sign != std::string_view::npos && sign > 0;
    std::string remedy = "write a name and its value, as in \"data: true\"";
    if (is_field && words[sign] == ':')
      remedy = "write a blank behind the ':', as in \"data: true\"";
    if (is_field && words[sign] == '=') remedy = "write ': ' for '=', as in \"data: true\"";
    return RequestFlaw{"this request gives no field a value", std::move(remedy)};
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string open_;          // the signs that close what is open, the innermost last
  bool begins_value_ = true;  // a quote or a bracket here is one of YAML
  bool is_quoted_ = false;    // a text in quotes ended here
  bool has_content_ = false;
  bool has_field_ = false;
  bool is_judged_ = true;
  std::optional<RequestFlaw> flaw_;
};

}  // namespace

std::optional<RequestFlaw> flaw_of_request(std::string_view yaml) {
  return RequestText(yaml).flaw();
}

}  // namespace culprit
