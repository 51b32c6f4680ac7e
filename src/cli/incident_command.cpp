#include <algorithm>
#include <memory>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "incident_reports/incident_json.h"
#include "incident_reports/incident_report.h"
#include "incident_reports/incident_words.h"
#include "incident_reports/regression.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

using incident_reports::Incident;

constexpr double kNanosecondInSeconds = 1e-9;

struct IncidentOptions {
  JournalOption journal;
  std::string id;
  std::string output;
  std::string since;
  std::string recordings;   // the folder; empty: that beside the journal
  std::string export_test;  // the folder; empty: none is made
  bool json = false;
};

std::filesystem::path recordings_beside(const IncidentOptions& options,
                                        const std::filesystem::path& journal) {
  if (options.recordings.empty()) return journal.parent_path() / "recordings";
  return options.recordings;
}

void print_incident(const Incident& incident,
                    const std::vector<recorder::StoredRecording>& recordings) {
  std::string names;
  for (const recorder::StoredRecording& each : recordings)
    names += "  " + each.path.filename().string();
  const auto began = static_cast<std::int64_t>(incident.began / kNanosecondInSeconds);
  fmt::print("{:<13} {:<24} {:>12}  {:<24} {}{}\n", escape_controls(incident.id), local_time(began),
             incident_reports::lasting_text(incident.seconds),
             escape_controls(incident_reports::cause_of(incident)),
             escape_controls(incident_reports::outcome_of(incident)), escape_controls(names));
}

int list_incidents(const IncidentOptions& options) {
  double since = 0;
  std::string within;
  if (!options.since.empty()) {
    const auto age = duration_of_option("--since", options.since);
    if (!age) return fail(age.error(), kUsage);
    within = " in the last " + to_string(*age);
    since = kNanosecondInSeconds *
            static_cast<double>(std::max<std::int64_t>(0, wall_now() - age->count()));
  }
  const auto path = options.journal.file();
  if (!path) return fail(path.error());
  const auto journal = journal::Reader::open(*path);
  if (!journal) return fail(journal.error());
  auto found = incident_reports::incidents_of(*journal, since);
  if (!found) return fail(found.error());
  const auto recordings = recorder::recordings_in(recordings_beside(options, *path));
  Json list = Json::array();
  if (!options.json && !found->incidents.empty())
    fmt::print("{:<13} {:<24} {:>12}  {:<24} {}\n", "id", "when", "for", "cause",
               "how it ended, and its recordings");
  for (Incident& incident : found->incidents) {
    if (!incident.is_over)
      incident.seconds = std::max(incident.seconds, found->newest - incident.began);
    const auto own = incident_reports::recordings_of(incident, recordings);
    if (options.json) {
      list.push_back(incident_reports::to_json(incident, own));
    } else {
      print_incident(incident, own);
    }
  }
  if (options.json) {
    fmt::print("{}\n", to_line({{"journal", path->string()},
                                {"oldest", found->oldest},
                                {"incidents", std::move(list)}}));
  } else if (found->incidents.empty()) {
    fmt::print("no incidents{} in {}\n", within, path->string());
  }
  return kOk;
}

// {"name", "about", "unit", "limits", "points": [[seconds since 1970, value] …]}
Json curve_as_json(const incident_reports::Curve& curve) {
  Json points = Json::array();
  for (const auto& point : curve.points)
    points.push_back({kNanosecondInSeconds * static_cast<double>(point.at), point.value});
  return {{"name", curve.name},
          {"about", curve.about},
          {"unit", curve.unit},
          {"limits", curve.limits},
          {"points", std::move(points)}};
}

Json report_as_json(const incident_reports::PageContent& content,
                    const std::vector<recorder::StoredRecording>& recordings) {
  Json json = incident_reports::to_json(
      content.incident, incident_reports::recordings_of(content.incident, recordings));
  json["robot"] = content.robot;
  json["events"] = content.events;
  json["requests"] = Json::array();
  for (const incident_reports::Request& each : content.requests)
    json["requests"].push_back({{"clock", each.clock},
                                {"text", each.text},
                                {"answer", each.answer},
                                {"seconds", each.seconds ? Json(*each.seconds) : Json()}});
  json["curves"] = Json::array();
  json["remarks"] = content.remarks;
  if (!content.curves) return json;
  for (const incident_reports::Curve& curve : content.curves->curves)
    json["curves"].push_back(curve_as_json(curve));
  for (const std::string& each : content.curves->remarks) json["remarks"].push_back(each);
  return json;
}

int write_incident(const IncidentOptions& options) {
  if (!incident_reports::began_by_id(options.id))
    return fail(
        "'" + printable(options.id) + "' is no id of an incident; culprit incident lists them",
        kUsage);
  const auto path = options.journal.file();
  if (!path) return fail(path.error());
  const auto journal = journal::Reader::open(*path);
  if (!journal) return fail(journal.error());
  const std::filesystem::path recordings = recordings_beside(options, *path);
  const auto content = incident_reports::report_of(
      *journal, options.id, recordings, kNanosecondInSeconds * static_cast<double>(wall_now()));
  if (!content) return fail(content.error());
  if (!*content)
    return fail("there is no incident '" + options.id + "' in '" + path->string() +
                "'; culprit incident --journal '" + path->string() + "' lists them");
  if (!options.json || !options.output.empty()) {
    const auto written = write_text(options.output, incident_reports::incident_page(**content));
    if (!written) return fail(written.error());
  }
  if (options.json)
    fmt::print("{}\n", to_line(report_as_json(**content, recorder::recordings_in(recordings))));
  std::vector<std::string> remarks = (*content)->remarks;
  if ((*content)->curves)
    remarks.insert(remarks.end(), (*content)->curves->remarks.begin(),
                   (*content)->curves->remarks.end());
  for (const std::string& each : remarks) say(stderr, "culprit: {}\n", escape_controls(each));
  return kOk;
}

int make_test(const IncidentOptions& options) {
  const auto path = options.journal.file();
  if (!path) return fail(path.error());
  const auto journal = journal::Reader::open(*path);
  if (!journal) return fail(journal.error());
  const auto made = incident_reports::export_test(
      *journal, options.id, recordings_beside(options, *path), options.export_test);
  if (!made) return fail(made.error());
  say(stderr, "culprit: {0} expects {1}; run it: culprit test {0}\n", made->test.string(),
      made->expectations == 1 ? "one thing" : fmt::format("{} things", made->expectations));
  return kOk;
}

}  // namespace

void add_incident(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<IncidentOptions>();
  CLI::App* command = app.add_subcommand("incident",
                                         "List the robot's incidents; or write one as a "
                                         "self-contained HTML file, with plots of its recordings");
  CLI::Option* id =
      command->add_option("ID", options->id, "The id from the list (default: list them)")
          ->type_name("INCIDENT");
  options->journal.add_to(*command);
  command
      ->add_option("--record-folder", options->recordings,
                   "Folder of the recordings (default: recordings beside the journal)")
      ->type_name("FOLDER");
  command->add_option("-o,--output", options->output, "Output file (default: stdout)")
      ->type_name("FILE")
      ->needs(id);
  command
      ->add_option("--since", options->since,
                   "Only incidents of the last 10min, 2h, 1d ..., and those that lasted until then")
      ->type_name("DURATION")
      ->excludes(id);
  command->add_flag("--json", options->json,
                    "The list, or the incident with its events and recordings, as JSON");
  command
      ->add_option("--export-test", options->export_test,
                   "Cut its recording, and write it with its rules and a test below this folder")
      ->type_name("FOLDER")
      ->needs(id)
      ->excludes(command->get_option("--output"))
      ->excludes(command->get_option("--json"));
  command->callback([options, &exit_code] {
    exit_code = options->id.empty()            ? list_incidents(*options)
                : options->export_test.empty() ? write_incident(*options)
                                               : make_test(*options);
  });
}

}  // namespace culprit::cli
