#include "fleet/clean.h"

#include "base/utf8.h"

namespace culprit::fleet {
namespace {

constexpr std::size_t kLongest = 200;

}  // namespace

std::string clean(std::string_view name) {
  std::string out;
  while (!name.empty() && out.size() < kLongest) {
    const std::size_t length = character_length(name);
    const bool is_control =
        length == 1 && (static_cast<unsigned char>(name[0]) < 0x20 || name[0] == 0x7F);
    if (length == 0 || is_control) {
      out += '?';
      name.remove_prefix(1);
      continue;
    }
    if (out.size() + length > kLongest) break;
    out += name.substr(0, length);
    name.remove_prefix(length);
  }
  return out;
}

}  // namespace culprit::fleet
