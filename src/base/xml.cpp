#include "base/xml.h"

#include "base/utf8.h"

namespace culprit {
namespace {

// XML allows neither U+FFFE nor U+FFFF.
bool is_allowed(std::string_view text) {
  return !text.starts_with("\xEF\xBF\xBE") && !text.starts_with("\xEF\xBF\xBF");
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
    const std::size_t length = is_allowed(text) ? character_length(text) : 0;
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
