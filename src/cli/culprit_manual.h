// The parts of culprit's manual beside its options.
#pragma once

#include <CLI/CLI.hpp>

#include "terminal/manual.h"

namespace culprit::cli {

const Manual& culprit_manual();

// Puts the commands under headings, by what people do with them.
void group_commands(CLI::App& app);

}  // namespace culprit::cli
