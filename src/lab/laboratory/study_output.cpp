#include "laboratory/study_output.h"

#include <fmt/core.h>

#include "base/text_file.h"
#include "study/csv.h"
#include "study/tables/render.h"
#include "study/tables/study_tables.h"
#include "suave_study/suave_report.h"
#include "sunset_study/json.h"

namespace culprit::lab {
namespace {

Expected<std::string> in_format(const study::Findings& findings, const std::string& format) {
  if (format == "json") return study::json(findings) + "\n";
  if (format == "csv") return study::metrics_csv(findings.campaign);
  if (format == "effects-csv") return study::effects_csv(findings.campaign);
  return tables_as(study::tables(findings), format);
}

// The output first: it is there even if the report fails.
Expected<void> write(const Expected<std::string>& output, const std::string& file) {
  return output ? write_text(file, *output) : Expected<void>(Error{output.error()});
}

}  // namespace

Expected<std::string> tables_as(const std::vector<study::Table>& tables,
                                const std::string& format) {
  if (format == "latex") return latex(tables);
  std::string out;
  for (const study::Table& table : tables) {
    out += out.empty() ? "" : "\n";
    out += format == "markdown" ? study::markdown(table) : study::text(table);
  }
  return out;
}

void StudyOutput::add_to(CLI::App& command, const std::string& formats_summary,
                         const std::vector<std::string>& formats) {
  command.add_option("--format", format, formats_summary)
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  command.add_flag_callback(
      "--json", [this] { format = "json"; }, "The same as --format json");
  command.add_option("-o,--output", output, "Write there (default: the terminal)")
      ->type_name("FILE");
  report.add_to(command);
}

void StudyOutput::add_to(CLI::App& command) {
  add_to(command,
         "text (tables, ours beside the paper's), markdown, latex, csv (each mean), "
         "effects-csv (each pairwise effect) or json",
         {"text", "markdown", "latex", "csv", "effects-csv", "json"});
}

void StudyOutput::add_suave_to(CLI::App& command) {
  add_to(command,
         "text (tables, ours beside the paper's), markdown, latex, json or, with --claims, csv",
         {"text", "markdown", "latex", "json", "csv"});
}

Expected<void> write(const study::Findings& findings, const StudyOutput& output) {
  const auto written = write(in_format(findings, output.format), output.output);
  if (!written || !output.report.is_wanted()) return written;
  return make_report("sunset",
                     {{"study.json", study::json(findings)},
                      {"metrics.csv", study::metrics_csv(findings.campaign)},
                      {"effects.csv", study::effects_csv(findings.campaign)},
                      {"values.csv", study::values_csv(findings.campaign)},
                      {"claims.csv", study::claims_csv(findings)},
                      {"tables.json", study::tables_json(study::tables(findings))},
                      {"timelines.json", study::timelines_json(findings.timelines)}},
                     output.report);
}

Expected<void> write(const study::SuaveResult& result, const StudyOutput& output) {
  if (output.format.ends_with("csv"))
    return Error{"SUAVE has no CSV; there are text, markdown, latex and json"};
  const std::string json = study::suave_json(result);
  const auto tables = study::suave_tables(result);
  const auto written =
      write(output.format == "json" ? json : tables_as(tables, output.format), output.output);
  if (!written || !output.report.is_wanted()) return written;
  return make_report("suave",
                     {{"study.json", json},
                      {"tables.json", study::tables_json(tables)},
                      {"tracks.json", study::tracks_json(std::string(result.campaign.plan->summary),
                                                         study::first_tracks(result.campaign))}},
                     output.report);
}

Expected<void> write(const study::Validation& validation, const StudyOutput& output) {
  if (output.report.is_wanted())
    return Error{"a validation is written as text, markdown, latex or json"};
  return write(output.format == "json"
                   ? study::validation_json(validation)
                   : tables_as(study::validation_tables(validation), output.format),
               output.output);
}

Expected<void> write(const std::vector<study::Table>& tables, const StudyOutput& output) {
  const bool is_table =
      output.format == "text" || output.format == "markdown" || output.format == "latex";
  if (!is_table || output.report.is_wanted())
    return Error{"this table is written as text, markdown or latex"};
  return write(tables_as(tables, output.format), output.output);
}

Expected<void> write_sweep(const std::vector<study::Table>& tables, const std::string& json,
                           const StudyOutput& output) {
  if (output.format.ends_with("csv"))
    return Error{"a sweep has no CSV; there are text, markdown, latex and json"};
  const auto written =
      write(output.format == "json" ? json : tables_as(tables, output.format), output.output);
  if (!written || !output.report.is_wanted()) return written;
  return make_report("sunset", {{"study.json", json}, {"tables.json", study::tables_json(tables)}},
                     output.report);
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
