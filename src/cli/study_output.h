// Where the findings of a study go: tables to the terminal or a file, a report beside them.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "language/expected.h"
#include "study/findings.h"

namespace culprit::cli {

struct StudyOutput {
  std::string format = "text";
  std::string output;       // empty: the standard output
  std::string html;         // a report; empty: none
  std::string plot_folder;  // empty: no plots

  // --format, --json, --output, --html, --svg
  void add_to(CLI::App& command);
};

// An error: a file cannot be written.
Expected<void> write(const study::Findings& findings, const StudyOutput& output);

// One run, a line for each happening.
std::string timeline_text(const study::Timeline& timeline);

}  // namespace culprit::cli
