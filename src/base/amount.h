// Numbers of things in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace culprit {

// "1 rule", "2 rules"; `several` where an s is not enough: "2 strategies".
std::string amount_of(std::size_t count, std::string_view one, std::string_view several = "");

}  // namespace culprit
