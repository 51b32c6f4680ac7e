// The options of `culprit run` in a file: culprit.toml.
//
//     rules = "my.rules"
//     web = true
//     healthy = "30s"
//
// Each key is an option without its dashes, and `rules` is the rule file. An option of the command line comes first,
// then its environment variable (CULPRIT_HEALTHY), then the file. The file is named by --config or CULPRIT_CONFIG.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"

namespace culprit::cli {

struct RunConfiguration {
  std::vector<std::string> words;  // the command line, with the options of the file at its end
  std::string printed;             // what --print-config asks for; empty: it was not given
};

// `words`: the command line from "run" on. A line that is wrong comes back as it is: its parser reports that.
// Errors: the file cannot be read, or has a mistake; "culprit.toml:3: …".
Expected<RunConfiguration> with_configuration(std::vector<std::string> words);

}  // namespace culprit::cli
