// The effect of formatting, as a unified diff.
//
// Formatting keeps the lines of a text and their order; it changes the blanks within them and
// leaves out blank lines. So which lines belong together is known, and nothing has to be searched.
#pragma once

#include <string>
#include <string_view>

namespace culprit::cli {

// `after` is the formatted `before`. Empty if both are the same.
std::string layout_diff(std::string_view name, std::string_view before, std::string_view after);

}  // namespace culprit::cli
