#include "cli/diagnostic_report.h"

#include <fmt/core.h>

#include "language/explanations.h"

namespace culprit::cli {
namespace {

const char* severity_of(const Diagnostic& d) {
  return d.severity == Severity::kError ? "error" : "warning";
}

// RFC 3986: a path is not yet a URI reference.
std::string uri_of(std::string_view path) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string uri = path.starts_with('/') ? "file://" : "";
  for (const char c : path) {
    if (kPlain.find(c) != std::string_view::npos) {
      uri += c;
    } else {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return uri;
}

Json sarif_rules() {
  Json rules = Json::array();
  for (const Explanation& e : explanations()) {
    rules.push_back({{"id", to_string(e.code)},
                     {"shortDescription", {{"text", e.title}}},
                     {"fullDescription", {{"text", e.why}}},
                     {"help", {{"text", page(e)}}}});
  }
  return rules;
}

Json json_place(const Source& source, Span span) {
  const Position begin = source.position(span.begin);
  const Position end = source.position(span.end);
  return {{"line", begin.line},
          {"column", begin.column},
          {"end_line", end.line},
          {"end_column", end.column}};
}

Json sarif_region(const Source& source, Span span) {
  const Position begin = source.position(span.begin);
  const Position end = source.position(span.end);
  return {{"startLine", begin.line},
          {"startColumn", begin.column},
          {"endLine", end.line},
          {"endColumn", end.column}};
}

Json sarif_place(const Source& file, Span span) {
  return {{"physicalLocation",
           {{"artifactLocation", {{"uri", uri_of(file.name())}}},
            {"region", sarif_region(file, span)}}}};
}

Json sarif_fix(const Source& file, const Edit& fix) {
  Json replacement{{"deletedRegion", sarif_region(file, fix.span)},
                   {"insertedContent", {{"text", fix.text}}}};
  Json change{{"artifactLocation", {{"uri", uri_of(file.name())}}},
              {"replacements", Json::array({std::move(replacement)})}};
  return {{"description", {{"text", title_of(fix, file)}}},
          {"artifactChanges", Json::array({std::move(change)})}};
}

Json sarif_result(const Source& source, const Diagnostic& d) {
  const std::string message = d.remedy.empty() ? d.cause : d.cause + "\n" + d.remedy;
  const LocatedDiagnostic here = located(d, source);
  const Source& file = source.file(here.place.file);
  Json result{{"ruleId", to_string(d.code)},
              {"level", severity_of(d)},
              {"message", {{"text", message}}},
              {"locations", Json::array({sarif_place(file, here.place.span)})}};
  for (const auto& note : here.notes) {
    Json place = sarif_place(source.file(note.place.file), note.place.span);
    place["message"] = {{"text", note.text}};
    result["relatedLocations"].push_back(std::move(place));
  }
  if (here.fix) result["fixes"] = Json::array({sarif_fix(file, *here.fix)});
  return result;
}

Json json_fix(const Source& source, const Edit& edit) {
  Json fix = json_place(source, edit.span);
  fix["text"] = edit.text;
  return fix;
}

}  // namespace

Json json_report(const std::vector<CheckedFile>& files) {
  Json report = Json::array();
  for (const auto& [source, diagnostics] : files) {
    for (const Diagnostic& d : diagnostics) {
      const LocatedDiagnostic here = located(d, source);
      const Source& file = source.file(here.place.file);
      Json entry{{"file", file.name()}, {"code", to_string(d.code)}, {"severity", severity_of(d)}};
      entry.update(json_place(file, here.place.span));
      entry["cause"] = d.cause;
      entry["remedy"] = d.remedy;
      if (here.fix) entry["fix"] = json_fix(file, *here.fix);
      for (const auto& note : here.notes) {
        Json place{{"note", note.text}, {"file", source.file(note.place.file).name()}};
        place.update(json_place(source.file(note.place.file), note.place.span));
        entry["notes"].push_back(std::move(place));
      }
      report.push_back(std::move(entry));
    }
  }
  return report;
}

Json sarif_report(const std::vector<CheckedFile>& files) {
  Json results = Json::array();
  for (const auto& [source, diagnostics] : files) {
    for (const Diagnostic& d : diagnostics) results.push_back(sarif_result(source, d));
  }
  Json driver{{"name", "culprit"}, {"rules", sarif_rules()}};
  Json run{{"tool", {{"driver", std::move(driver)}}},
           {"columnKind", "unicodeCodePoints"},
           {"results", std::move(results)}};
  return {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
          {"version", "2.1.0"},
          {"runs", Json::array({std::move(run)})}};
}

std::string to_text(const Json& document) { return to_indented(document); }

}  // namespace culprit::cli
