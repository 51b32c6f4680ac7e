// Options that take a duration.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace culprit {

// "--for 8s", "--for 1.5min", "--for 500ms"; a number alone is of seconds. `value`, in seconds, is
// the default, and has to be from `least` to `most`.
CLI::Option* add_seconds(CLI::App& command, const std::string& name, double& value,
                         const std::string& what, double least, double most);

}  // namespace culprit
