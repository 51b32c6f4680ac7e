#include "base/xml.h"

#include <cstdint>

namespace culprit {
namespace {

// How many bytes the character of more than one byte at the front has; 0 if there is none that XML
// allows. Overlong forms and surrogates are no UTF-8; U+FFFE and U+FFFF are not allowed.
std::size_t long_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  std::uint32_t point = byte(0) & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
    point = point << 6 | (byte(i) & 0x3Fu);
  }
  const std::uint32_t least = length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
  const bool is_surrogate = point >= 0xD800 && point <= 0xDFFF;
  const bool is_allowed =
      point >= least && point <= 0x10FFFF && !is_surrogate && point != 0xFFFE && point != 0xFFFF;
  return is_allowed ? length : 0;
}

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    default:
      return "";
  }
}

}  // namespace

std::string xml_escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const char c = text.front();
    const bool is_ascii = static_cast<unsigned char>(c) < 0x80;
    const std::size_t length = is_ascii ? 1 : long_character(text);
    const bool is_printable = static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
    if (length > 1) {
      out += text.substr(0, length);
    } else if (length == 1 && (is_printable || c == '\n' || c == '\t')) {
      const std::string_view escape = entity(c);
      out += escape.empty() ? std::string_view(&c, 1) : escape;
    } else {
      out += '?';
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace culprit
