// culprit-lab play-again: one run of a campaign, for the page's timeline (web/calls.h).
#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>

#include "base/text_file.h"
#include "laboratory/commands.h"
#include "laboratory/play_again.h"
#include "terminal/console.h"
#include "web/event_json.h"

namespace culprit::lab {
namespace {

Json to_json(const study::TimelineEntry& incident) {
  const std::string_view name = study::name(incident.kind);
  const bool is_fault = incident.kind == study::Happening::kFault;
  Json json{{"t", std::round(incident.time_s * 1000) / 1000}};
  json.update(web::to_json(
      EventWords{name, name, EventSeverity::kInfo, is_fault ? Tone::kAlarm : Tone::kAside}));
  json["component"] = incident.component;
  json["text"] = incident.text;
  return json;
}

// As the live stream has them. Events without a text are left out, as there.
Json to_json(const study::SingleRun& run) {
  std::vector<Json> events;
  for (const study::TimelineEntry& incident : run.incidents) events.push_back(to_json(incident));
  for (const Event& event : run.events) {
    Json json = web::to_json(event, run.rules, Time{});
    const bool is_told = !json["text"].get_ref<const std::string&>().empty();
    if (is_told || json.contains("incident")) events.push_back(std::move(json));
  }
  std::stable_sort(events.begin(), events.end(), [](const Json& a, const Json& b) {
    return a["t"].get<double>() < b["t"].get<double>();
  });
  return {{"scenario", run.scenario},
          {"is_told", run.is_told},
          {"end", run.end_s},
          {"events", std::move(events)}};
}

bool is_natural(const Json& request, const char* member) {
  return request.contains(member) && request[member].is_number_unsigned();
}

int answer(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return fail(text.error(), kUsage);
  const Json request = parse_json(*text);
  const bool is_whole = request.is_object() && request.contains("study") &&
                        request["study"].is_string() && request.contains("campaign") &&
                        is_natural(request, "row") && is_natural(request, "run");
  if (!is_whole) return fail("'" + path + "' is no request for a run", kUsage);
  const auto run =
      play_again(request["study"].get<std::string>(), request["campaign"],
                 {request["row"].get<std::uint32_t>(), request["run"].get<std::uint32_t>()});
  if (!run) return fail(run.error());
  say_text(stdout, to_line(to_json(*run)) + "\n");
  return kOk;
}

}  // namespace

void add_play_again(CLI::App& app, int& exit_code) {
  auto path = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "play-again", "Play one run of a campaign again, and write what happened as JSON");
  command
      ->add_option("REQUEST", *path,
                   "A JSON file: {study, campaign, row, run}, as they stand in a campaign's result")
      ->required();
  command->callback([path, &exit_code] { exit_code = answer(*path); });
}

}  // namespace culprit::lab
