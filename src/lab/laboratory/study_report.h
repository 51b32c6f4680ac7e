// Reports of studies: scripts of Python (share/culprit/studies) draw them from files that this
// program writes (docs/study-files.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/expected.h"
#include "study/tables/table.h"

namespace culprit::lab {

struct ReportOptions {
  std::string folder;       // --report; empty: none
  std::string html;         // --html; empty: none
  std::string plot_folder;  // --svg; empty: none

  bool is_wanted() const { return !folder.empty() || !html.empty() || !plot_folder.empty(); }
  // --report, --html, --svg
  void add_to(CLI::App& command);
};

struct ReportFile {
  std::string name;
  std::string text;
};

// To be called before a long campaign: prints a warning if Python or one of its libraries is absent.
void warn_of_missing_python(const ReportOptions& options);

// Writes `files` into the report's folder, or a temporary one, and runs the script of `study`.
// Errors: a file cannot be written; Python or a library is absent, with the packages to install; the
// script failed.
Expected<void> make_report(const std::string& study, const std::vector<ReportFile>& files,
                           const ReportOptions& options);

// Tables as LaTeX. Errors: as above, but no library is needed.
Expected<std::string> latex(const std::vector<study::Table>& tables);

// Runs a script, {"python3", its path, ...}, to its end; what it prints is in `log`. Errors: it cannot
// be started, or it failed: then the last line that it printed.
Expected<void> run_python(std::vector<std::string> arguments, const std::filesystem::path& log);

// The first Python, of PATH or Debian's, that has the libraries of reports. Errors: none has.
Expected<std::string> find_report_python();

}  // namespace culprit::lab
