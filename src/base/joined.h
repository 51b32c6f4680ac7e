// Texts in a row: "a, b, c".
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace culprit {

// `text_of` gives the text of one of `all`; of those that are texts it is themselves.
template <class All, class TextOf = std::identity>
std::string joined(const All& all, std::string_view between = ", ", TextOf text_of = {}) {
  std::string out;
  for (const auto& each : all) {
    if (!out.empty()) out += between;
    out += std::invoke(text_of, each);
  }
  return out;
}

}  // namespace culprit
