// Where the findings of a study go: tables to the terminal or a file, a report beside them.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "study/findings.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"
#include "suave_study/validation.h"

namespace culprit::lab {

struct StudyOutput {
  std::string format = "text";
  std::string output;       // empty: the standard output
  std::string html;         // a report; empty: none
  std::string plot_folder;  // empty: no plots

  // --format, --json, --output, --html, --svg
  void add_to(CLI::App& command);
  // The same without what SUAVE has not: CSV and plots.
  void add_suave_to(CLI::App& command);

 private:
  void add_to(CLI::App& command, const std::string& formats_summary,
              const std::vector<std::string>& formats);
};

// An error: a file cannot be written, or there is no such format of this study.
Expected<void> write(const study::Findings& findings, const StudyOutput& output);
Expected<void> write(const study::SuaveResult& result, const StudyOutput& output);
Expected<void> write(const study::Validation& validation, const StudyOutput& output);
// As text, markdown or latex.
Expected<void> write(const std::vector<study::Table>& tables, const StudyOutput& output);

// One run, a line for each happening.
std::string timeline_text(const study::Timeline& timeline);

}  // namespace culprit::lab
