// Where the findings of a study go: tables to the terminal or a file, a report beside them.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "laboratory/study_report.h"
#include "study/findings.h"
#include "study/tables/table.h"
#include "suave_study/campaign.h"
#include "suave_study/validation.h"

namespace culprit::lab {

struct StudyOutput {
  std::string format = "text";
  std::string output;  // empty: the standard output
  ReportOptions report;

  // --format, --json, --output, --report, --html, --svg
  void add_to(CLI::App& command);
  // The same without the CSV that SUAVE does not have.
  void add_suave_to(CLI::App& command);

 private:
  void add_to(CLI::App& command, const std::string& formats_summary,
              const std::vector<std::string>& formats);
};

// Tables as text, markdown or latex.
Expected<std::string> tables_as(const std::vector<study::Table>& tables, const std::string& format);

// An error: a file cannot be written, there is no such format of this study, or the report cannot be
// made. The output is written before the report.
Expected<void> write(const study::Findings& findings, const StudyOutput& output);
Expected<void> write(const study::SuaveResult& result, const StudyOutput& output);
Expected<void> write(const study::Validation& validation, const StudyOutput& output);
// As text, markdown or latex.
Expected<void> write(const std::vector<study::Table>& tables, const StudyOutput& output);
// A sweep: its tables, and its points as JSON (sunset_study/sweep.h).
Expected<void> write_sweep(const std::vector<study::Table>& tables, const std::string& json,
                           const StudyOutput& output);

// One run, a line for each happening.
std::string timeline_text(const study::Timeline& timeline);

}  // namespace culprit::lab
