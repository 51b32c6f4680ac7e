// A program's commands and options without the hidden ones. The manual and the shells' completion are made of it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace culprit {

// The commands of `app`, in their order.
std::vector<const CLI::App*> commands_in(const CLI::App& app);

// The command of this name, listed or not; null if there is none.
const CLI::App* command_named(const CLI::App& app, const std::string& name);

// The options and the positional arguments of `command` but --help.
std::vector<const CLI::Option*> options_in(const CLI::App& command);

}  // namespace culprit
