#include "laboratory/study_output.h"

#include <fmt/core.h>

#include "base/text_file.h"
#include "study/csv.h"
#include "study/plot/plots.h"
#include "study/report/html_report.h"
#include "study/tables/render.h"
#include "study/tables/study_tables.h"
#include "suave_study/html_report.h"
#include "suave_study/report.h"
#include "sunset_study/json.h"

namespace culprit::lab {
namespace {

std::string tables_as(const std::vector<study::Table>& tables, const std::string& format) {
  std::string out;
  for (const study::Table& table : tables) {
    out += out.empty() ? "" : "\n";
    out += format == "markdown" ? study::markdown(table)
           : format == "latex"  ? study::latex(table)
                                : study::text(table);
  }
  return out;
}

std::string in_format(const study::Findings& findings, const std::string& format) {
  if (format == "json") return study::json(findings) + "\n";
  if (format == "csv") return study::metrics_csv(findings.campaign);
  if (format == "effects-csv") return study::effects_csv(findings.campaign);
  return tables_as(study::tables(findings), format);
}

}  // namespace

void StudyOutput::add_to(CLI::App& command, const std::string& formats_summary,
                         const std::vector<std::string>& formats) {
  command.add_option("--format", format, formats_summary)
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  command.add_flag_callback(
      "--json", [this] { format = "json"; }, "The same as --format json");
  command.add_option("-o,--output", output, "Write there (default: the terminal)")
      ->type_name("FILE");
}

void StudyOutput::add_to(CLI::App& command) {
  add_to(command,
         "text (tables, ours beside the paper's), markdown, latex, csv (each mean), "
         "effects-csv (each pairwise effect) or json",
         {"text", "markdown", "latex", "csv", "effects-csv", "json"});
  command.add_option("--html", html, "Also write a report, as one self-contained page")
      ->type_name("FILE");
  command.add_option("--svg", plot_folder, "Also write each plot into this folder, for papers")
      ->type_name("FOLDER");
}

void StudyOutput::add_suave_to(CLI::App& command) {
  add_to(command, "text (tables, ours beside the paper's), markdown, latex or json",
         {"text", "markdown", "latex", "json"});
  command
      .add_option("--html", html,
                  "Also write a report there: tables, and the first run of each manager, moving")
      ->type_name("FILE");
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
  return write_text(output.output, in_format(findings, output.format));
}

Expected<void> write(const study::SuaveResult& result, const StudyOutput& output) {
  if (!output.plot_folder.empty() || output.format.ends_with("csv"))
    return Error{
        "of SUAVE there are neither plots nor CSV; there are text, markdown, latex, json "
        "and --html"};
  if (!output.html.empty()) {
    auto written =
        write_text(output.html, study::suave_html(result, study::first_tracks(result.campaign)));
    if (!written) return written;
  }
  return write_text(output.output, output.format == "json"
                                       ? study::suave_json(result)
                                       : tables_as(study::suave_tables(result), output.format));
}

Expected<void> write(const study::Validation& validation, const StudyOutput& output) {
  if (!output.html.empty())
    return Error{"a validation is written as text, markdown, latex or json"};
  return write_text(output.output,
                    output.format == "json"
                        ? study::validation_json(validation)
                        : tables_as(study::validation_tables(validation), output.format));
}

Expected<void> write(const std::vector<study::Table>& tables, const StudyOutput& output) {
  const bool is_table =
      output.format == "text" || output.format == "markdown" || output.format == "latex";
  if (!is_table || !output.html.empty() || !output.plot_folder.empty())
    return Error{"this table is written as text, markdown or latex"};
  return write_text(output.output, tables_as(tables, output.format));
}

std::string timeline_text(const study::Timeline& timeline) {
  std::string out = fmt::format("run {} of {}: {}\n", timeline.run,
                                study::label(timeline.configuration), timeline.scenario);
  for (const study::TimelineEntry& entry : timeline.entries) {
    out += fmt::format("{:8.3f}  {:<10}  {}\n", entry.time_s, study::name(entry.kind), entry.text);
  }
  return out;
}

}  // namespace culprit::lab
