#include "base/wrapped.h"

#include <utility>

namespace culprit {

std::string wrapped(const std::string& text, std::size_t columns) {
  std::string out;
  std::size_t column = 0;
  std::string word;
  const auto end_word = [&] {
    if (word.empty()) return;
    if (column > 0 && column + 1 + word.size() > columns) {
      out += '\n';
      column = 0;
    }
    if (column > 0) out += ' ';
    column += (column > 0 ? 1 : 0) + word.size();
    out += std::exchange(word, "");
  };
  for (const char c : text) {
    if (c != ' ' && c != '\n') {
      word += c;
      continue;
    }
    end_word();
    if (c == '\n') {
      out += '\n';
      column = 0;
    }
  }
  end_word();
  return out;
}

}  // namespace culprit
