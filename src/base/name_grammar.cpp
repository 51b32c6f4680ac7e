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

std::string escape_controls(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned c = byte(i);
    // U+0080 to U+009F, and U+202A to U+202E, U+2066 to U+2069, as UTF-8 has them.
    const bool is_second_set = c == 0xc2 && byte(i + 1) >= 0x80 && byte(i + 1) < 0xa0;
    const unsigned last = byte(i + 2);
    const bool is_direction = c == 0xe2 && ((byte(i + 1) == 0x80 && last >= 0xaa && last <= 0xae) ||
                                            (byte(i + 1) == 0x81 && last >= 0xa6 && last <= 0xa9));
    if (c < ' ' || c == 0x7f || is_second_set) {
      const unsigned code = is_second_set ? byte(++i) : c;
      out += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
    } else if (is_direction) {
      const unsigned low = (byte(i + 1) & 1) << 6 | (last & 0x3f);
      out += {'\\', 'u', '2', '0', kDigits[low >> 4], kDigits[low & 15]};
      i += 2;
    } else {
      out += static_cast<char>(c);
    }
  }
  return out;
}

std::string escape_lines(std::string_view text) {
  std::string out;
  while (true) {
    const auto end = text.find_first_of("\n\t");
    out += escape_controls(text.substr(0, end));
    if (end == std::string_view::npos) return out;
    out += text[end];
    text.remove_prefix(end + 1);
  }
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
