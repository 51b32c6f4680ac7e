#include "base/value_list.h"

#include <algorithm>

namespace culprit {
namespace {

constexpr std::string_view kBetween = " \t\r\n";

class ListReader {
 public:
  explicit ListReader(std::string_view text) : text_(text) {}

  std::optional<std::vector<Value>> read() {
    if (!take('[')) return std::nullopt;
    std::vector<Value> list;
    if (take(']')) return ends() ? std::optional(list) : std::nullopt;
    while (true) {
      auto element = next() == '"' ? quoted() : word();
      if (!element) return std::nullopt;
      list.push_back(std::move(*element));
      if (take(']')) return ends() ? std::optional(list) : std::nullopt;
      if (!take(',')) return std::nullopt;
    }
  }

 private:
  char next() {
    const auto at = text_.find_first_not_of(kBetween);
    text_.remove_prefix(at == std::string_view::npos ? text_.size() : at);
    return text_.empty() ? '\0' : text_.front();
  }
  bool ends() { return next() == '\0' && text_.empty(); }
  bool take(char c) {
    if (next() != c || text_.empty()) return false;
    text_.remove_prefix(1);
    return true;
  }

  std::optional<Value> quoted() {
    std::string out;
    for (std::size_t i = 1; i < text_.size(); ++i) {
      const bool is_escaped = text_[i] == '\\' && i + 1 < text_.size();
      if (text_[i] == '"') {
        text_.remove_prefix(i + 1);
        return Value(std::move(out));
      }
      if (is_escaped) ++i;
      const char c = text_[i];
      out += !is_escaped ? c : c == 'n' ? '\n' : c == 't' ? '\t' : c;
    }
    return std::nullopt;
  }

  std::optional<Value> word() {
    const std::size_t end = std::min(text_.find_first_of(",]"), text_.size());
    const std::string_view word = text_.substr(0, end);
    if (word.find_first_not_of(kBetween) == std::string_view::npos ||
        word.find_first_of("[{\"") != std::string_view::npos)
      return std::nullopt;
    text_.remove_prefix(end);
    return value_from_text(word);
  }

  std::string_view text_;
};

}  // namespace

std::optional<std::vector<Value>> list_from_text(std::string_view text) {
  return ListReader(text).read();
}

std::string text_of_list(const std::vector<Value>& list) {
  std::string out = "[";
  for (const Value& each : list) out += (out.size() == 1 ? "" : ", ") + to_string(each);
  return out + "]";
}

}  // namespace culprit
