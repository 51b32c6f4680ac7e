// A command line that cannot be understood: the mistake in the words of people, and its remedy.
// CLI11 has its own words for each.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace culprit {

// The command that the line names, and how it is called: "culprit beliefs show".
struct Chosen {
  const CLI::App* command;
  std::string path;
  int depth = 0;  // words of `path` behind the program's name
};
Chosen chosen(const CLI::App& app);
// The same before the line is parsed.
Chosen named_in(const CLI::App& app, int argc, char** argv);

// One line, without a point at its end. `error`: that parsing ended with.
std::string cause_of_wrong_call(const CLI::ParseError& error, const CLI::App& app,
                                const Chosen& line, int argc, char** argv);

// A value that CLI11 would take for something else: "--for 10 minutes", "--journal --web". Nothing: no such value is there.
std::optional<std::string> slip_of_values(const CLI::App& command, int argc, char** argv);

// CLI11's message about the value of an option in the words of people: "--port: '0' is no number from
// 1 to 9".
std::string words_of_invalid_value(const std::string& text);

}  // namespace culprit
