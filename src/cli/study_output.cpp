#include "cli/study_output.h"

#include <fmt/core.h>

#include "language/text_file.h"
#include "study/csv.h"
#include "study/json.h"
#include "study/plot/plots.h"
#include "study/report/html_report.h"
#include "study/tables/render.h"
#include "study/tables/study_tables.h"

namespace culprit::cli {
namespace {

std::string tables_as(const study::Findings& findings, std::string (*render)(const study::Table&)) {
  std::string out;
  for (const study::Table& table : study::tables(findings))
    out += (out.empty() ? "" : "\n") + render(table);
  return out;
}

std::string in_format(const study::Findings& findings, const std::string& format) {
  if (format == "json") return study::json(findings) + "\n";
  if (format == "csv") return study::metrics_csv(findings.campaign);
  if (format == "effects-csv") return study::effects_csv(findings.campaign);
  if (format == "markdown") return tables_as(findings, study::markdown);
  if (format == "latex") return tables_as(findings, study::latex);
  return tables_as(findings, study::text);
}

}  // namespace

void StudyOutput::add_to(CLI::App& command) {
  command
      .add_option("--format", format,
                  "text (tables, ours beside the paper's), markdown, latex, csv (each mean), "
                  "effects-csv (each pairwise effect) or json")
      ->check(CLI::IsMember({"text", "markdown", "latex", "csv", "effects-csv", "json"}))
      ->capture_default_str();
  command.add_flag_callback(
      "--json", [this] { format = "json"; }, "The same as --format json");
  command.add_option("-o,--output", output, "Write there (default: the terminal)");
  command.add_option("--html", html, "Also write a report: one page that needs nothing else");
  command.add_option("--svg", plot_folder, "Also write each plot into this folder, for papers");
}

Expected<void> write(const study::Findings& findings, const StudyOutput& output) {
  if (!output.html.empty()) {
    auto written = write_text(output.html, study::html_report(findings, "SUNSET"));
    if (!written) return written;
  }
  if (!output.plot_folder.empty()) {
    auto written = study::write_plots(findings, output.plot_folder);
    if (!written) return written;
  }
  const std::string text = in_format(findings, output.format);
  return write_text(output.output, text);
}

std::string timeline_text(const study::Timeline& timeline) {
  std::string out = fmt::format("run {} of {}: {}\n", timeline.run,
                                study::label(timeline.configuration), timeline.scenario);
  for (const study::TimelineEntry& entry : timeline.entries) {
    out += fmt::format("{:8.3f}  {:<10}  {}\n", entry.time_s, study::name(entry.kind), entry.text);
  }
  return out;
}

}  // namespace culprit::cli
