// Lists of values, as texts: what a parameter holds that is a list, in a language whose values are
// single ones.
//
//     [1, 2]   [0.5, 1.0]   [true, false]   ["left", "right"]   [left, right]   []
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/value.h"

namespace culprit {

// Words without quotes are texts unless they are true, false or numbers. Empty: this is no list, or
// one of lists.
std::optional<std::vector<Value>> list_from_text(std::string_view text);

// One text for each list.
std::string text_of_list(const std::vector<Value>& list);

}  // namespace culprit
