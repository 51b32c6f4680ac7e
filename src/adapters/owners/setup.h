// The environment that a shell file sets up: SETUP /opt/ros/humble/setup.bash.
//
// The only shell that culprit runs. Its line is always the same: it sources the file, whose name is
// an argument and no part of that line, and prints the environment. A user who may change the file
// can run anything as culprit's user, so the caller must trust the file (live/setups.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"

namespace culprit::owners {

// Longer than a workspace with a hundred packages takes on a slow computer.
inline constexpr Duration kSetup = std::chrono::seconds(10);

// Returns "NAME=value" for each variable that `file` leaves, after culprit's own environment and
// `given`. The shell that reads it has no input, none of culprit's files and none of its
// capabilities, and is killed after `limit`. The variables in `given` keep their values, whatever
// the file sets. Errors, with the last output of the file: it failed, took too long, or printed
// more than an environment.
Expected<std::vector<std::string>> environment_after(const std::filesystem::path& file,
                                                     const std::vector<std::string>& given,
                                                     Duration limit = kSetup);

}  // namespace culprit::owners
