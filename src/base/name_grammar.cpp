#include "base/name_grammar.h"

#include <algorithm>

namespace culprit {
namespace {

// rmw: 255 minus room for the mangling.
constexpr std::size_t kMaxTopicName = 247;
constexpr std::size_t kMaxNamespace = 245;
constexpr std::size_t kMaxNodeName = 255;

// Locale-free on purpose.
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_token(std::string_view token) {
  return !token.empty() && !is_digit(token.front()) &&
         std::ranges::all_of(token, [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

bool is_absolute_name(std::string_view name) {
  if (!name.starts_with('/')) return false;
  name.remove_prefix(1);
  while (true) {
    const auto slash = name.find('/');
    if (!is_token(name.substr(0, slash))) return false;
    if (slash == std::string_view::npos) return true;
    name.remove_prefix(slash + 1);
  }
}

}  // namespace

bool is_valid_topic_name(std::string_view name) {
  return name.size() <= kMaxTopicName && is_absolute_name(name);
}

bool is_valid_node_name(std::string_view name) {
  return name.size() <= kMaxNodeName && is_token(name);
}

bool is_valid_namespace(std::string_view name) {
  return name == "/" || (name.size() <= kMaxNamespace && is_absolute_name(name));
}

bool is_valid_type_name(std::string_view type) {
  const auto first = type.find('/');
  const auto last = type.rfind('/');
  if (first == std::string_view::npos || first == last) return false;
  const auto kind = type.substr(first + 1, last - first - 1);
  return is_token(type.substr(0, first)) && (kind == "msg" || kind == "srv" || kind == "action") &&
         is_token(type.substr(last + 1));
}

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string out(text.substr(0, kLongest));
  std::ranges::replace_if(
      out, [](char c) { return c < ' ' || c > '~'; }, '?');
  if (text.size() > kLongest) out += "...";
  return out;
}

}  // namespace culprit
