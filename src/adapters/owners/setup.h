// What a file of shell makes of an environment: SETUP /opt/ros/humble/setup.bash.
//
// The only shell that culprit runs. Its line is always the same: it sources the file, whose name is
// an argument and no part of that line, and prints the environment. Who may change the file decides
// what runs as culprit's user, so the caller has to trust it (live/setups.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"

namespace culprit::owners {

// Longer than a workspace with a hundred packages takes on a slow computer.
inline constexpr Duration kSetup = std::chrono::seconds(10);

// "NAME=value" for each variable after culprit's own environment and `given` went through `file`,
// in a process without input, without culprit's files and without its capabilities, which is killed
// after `limit`. What is `given` holds, whatever the file says. Errors, with what the file said
// last: it failed, took too long, or printed more than an environment.
Expected<std::vector<std::string>> environment_after(const std::filesystem::path& file,
                                                     const std::vector<std::string>& given,
                                                     Duration limit = kSetup);

}  // namespace culprit::owners
