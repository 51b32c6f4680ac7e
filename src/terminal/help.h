// How --help looks: lines that fit a terminal, and of each option what it takes and what it is by default.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace culprit {

// The value of an option: "{text,json}", "DURATION", "FILE ..."; empty: it has none.
std::string value_of(const CLI::Option& option);

// The purpose of an option, and its default: "How many of the latest rows (default: 50)".
std::string purpose_of(const CLI::Option& option);

std::shared_ptr<CLI::FormatterBase> help_formatter();

// Adds the command `help`, which prints the help of the command that it is given, or the program's.
// `app` must outlive the call of the command.
void add_help(CLI::App& app, int& exit_code);

}  // namespace culprit
