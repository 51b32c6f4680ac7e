#include "init/draft_names.h"

#include <cctype>

#include "language/reserved_words.h"

namespace culprit::init {
namespace {

constexpr std::size_t kLongestName = 100;  // a name of the language has at most 255 bytes

// "Motor 1: left" -> "Motor_1_left".
std::string identifier_of(const std::string& wanted) {
  std::string name;
  for (const char c : wanted) {
    const bool fits = static_cast<unsigned char>(c) < 0x80 && (std::isalnum(c) != 0 || c == '_');
    if (fits)
      name += c;
    else if (!name.empty() && !name.ends_with('_'))
      name += '_';
  }
  if (name.size() > kLongestName) name.resize(kLongestName);
  if (name.empty()) return "unnamed";
  return std::isdigit(name.front()) != 0 ? "n" + name : name;
}

}  // namespace

Names::Names() : taken_(reserved_words().begin(), reserved_words().end()) {
  taken_.insert({"true", "false"});
}

std::string Names::take(const std::string& wanted, const std::string& suffix) {
  const std::string name = identifier_of(wanted) + suffix;
  std::string free = name;
  for (int number = 2; !taken_.insert(free).second; ++number)
    free = name + "_" + std::to_string(number);
  return free;
}

}  // namespace culprit::init
