// How findings put quantities and lists.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.h"

namespace culprit::doctor {

// "3 nodes", "1 node".
std::string count_of(std::size_t count, std::string_view what);

// "/a, /b, /c and 4 more".
std::string listed(const std::vector<std::string>& names, std::size_t most = 3);

// "0.25 s", "3 min": three digits at most. "none" for what has no end.
std::string duration(Duration time);

// "3.2 GB".
std::string bytes(std::int64_t count);

}  // namespace culprit::doctor
