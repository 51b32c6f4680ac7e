// Options that take a duration.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "base/time.h"

namespace culprit {

// How long ago: "8s", "1.5min", "2h"; a number alone is of seconds. Errors name the option:
// "--since: ...".
Expected<Duration> duration_of_option(const std::string& name, const std::string& text);

// "--for 8s", "--for 1.5min", "--for 500ms"; a number alone is of seconds. `value`, in seconds, is
// the default, and has to be from `least` to `most`.
CLI::Option* add_seconds(CLI::App& command, const std::string& name, double& value,
                         const std::string& what, double least, double most);

}  // namespace culprit
