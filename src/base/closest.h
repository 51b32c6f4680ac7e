// Suggests the known name that was probably meant by an unknown one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit {

// The known name that `name` was probably meant to be; empty if none is near.
// Near is an edit distance of at most a third of the longer name.
std::string closest(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace culprit
