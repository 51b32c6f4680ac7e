// Options that take a duration.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "base/time.h"

namespace culprit {

// A duration as people type it: that of the rule language ("500ms", "1.5min"), and "10m" for
// minutes, "1d" for a day; a number alone is of seconds.
Expected<Duration> typed_duration(const std::string& text);

// How long ago, as typed_duration() reads it. Errors name the option: "--since: ...".
Expected<Duration> duration_of_option(const std::string& name, const std::string& text);

// An option with a duration as typed_duration() reads it. `value`, in seconds, is the default, and
// has to be from `least` to `most`.
CLI::Option* add_seconds(CLI::App& command, const std::string& name, double& value,
                         const std::string& what, double least, double most);

}  // namespace culprit
