// The manual of a program, made of its own commands and options: as a page for man(1), and as a page of docs/. So
// neither can say anything else than the program's --help.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace culprit {

// The part of the manual beyond the options.
struct Manual {
  using Entries = std::vector<std::pair<std::string, std::string>>;
  std::string name;                        // "culprit"
  std::string purpose;                     // "keep ROS 2 robots working"
  std::vector<std::string> description{};  // paragraphs
  Entries files{};
  Entries environment{};
  Entries examples{};      // a command, and what it is for
  std::string see_also{};  // "culprit-lab(1)"
  // Commands under this heading are another program's, which has them by the same names.
  struct {
    std::string heading{};  // "The laboratory"; empty: there are none
    std::string program{};  // "culprit-lab"
  } others{};
};

// "culprit run [OPTIONS] RULES"; `path`: "culprit run".
std::string usage_of(const CLI::App& command, const std::string& path);

// How a command ends, the same for all (terminal/command.h).
const Manual::Entries& exit_statuses();

// For the end of --help.
std::string examples_of(const Manual& manual);

// man(7)
std::string as_man_page(const CLI::App& app, const Manual& manual);
// The page of one command: culprit-run(1).
std::string as_man_page_of(const CLI::App& command, const Manual& manual);
std::string as_markdown(const CLI::App& app, const Manual& manual);

// Adds the command `manual` to the program, which is not listed. It prints either, or a shell's completion
// (terminal/completion.h), or the page of one command, or writes the pages of all commands to a folder. Both must live as long as `app`.
void add_manual(CLI::App& app, const Manual& manual, int& exit_code);

}  // namespace culprit
