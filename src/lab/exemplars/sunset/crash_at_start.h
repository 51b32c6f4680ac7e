// A fault of the demonstration: a process that ends at once whenever it is started.
//
// The experimenter arms it with a file in the state folder, "<name>.crashes", that holds how many
// starts are to fail; sunset-node counts it down.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/expected.h"

namespace culprit::sunset {

// The next `starts` starts of `name` fail; 0 disarms.
Expected<void> arm_crash(const std::filesystem::path& state, std::string_view name, int starts);

// Whether this start is to fail. Counts it.
bool take_crash(const std::filesystem::path& state, std::string_view name);

}  // namespace culprit::sunset
