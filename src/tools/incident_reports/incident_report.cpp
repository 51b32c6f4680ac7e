#include "incident_reports/incident_report.h"

#include <algorithm>
#include <charconv>

#include "incident_reports/incident_json.h"
#include "incident_reports/journal_incidents.h"
#include "language/checker.h"

namespace culprit::incident_reports {
namespace {

bool is_digit_of_id(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z'); }

Expected<std::optional<Incident>> incident_named(const journal::Reader& journal,
                                                 const std::string& id) {
  constexpr double kBefore = 60;  // s: what led to it is told before it
  const auto began = began_by_id(id);
  if (!began) return std::optional<Incident>();
  const auto told = opened_at(journal, id);
  if (!told) return Error{told.error()};
  const double since = std::min(*began, told->value_or(*began));  // the clock on the wall may jump
  const auto found = incidents_of(journal, std::max(0.0, since - kBefore));
  if (!found) return Error{found.error()};
  for (const Incident& each : found->incidents) {
    if (each.id != id) continue;
    Incident incident = each;
    if (!incident.is_over)
      incident.seconds = std::max(incident.seconds, found->newest - incident.began);
    return std::optional(std::move(incident));
  }
  return std::optional<Incident>();
}

// All components that may be involved: the blamed ones, and those that the failed rules are about.
std::vector<std::string> concerned(const Incident& incident, const RuleSet& rules) {
  std::vector<std::string> components = incident.causes;
  for (const Rule& rule : rules.rules) {
    if (std::ranges::find(incident.rules, rule.name) == incident.rules.end()) continue;
    for (const ComponentId id : rule.components) {
      if (std::ranges::find(components, rules[id].name) == components.end())
        components.push_back(rules[id].name);
    }
  }
  return components;
}

// The recording with the incident's beginning: the last that was begun until then. The event that starts a recording is reported a moment before it.
const recorder::StoredRecording& main_recording(const std::vector<recorder::StoredRecording>& own,
                                                const Incident& incident) {
  constexpr double kMoment = 2;  // s
  const recorder::StoredRecording* chosen = &own.front();
  for (const recorder::StoredRecording& each : own) {
    if (static_cast<double>(each.when) * 1e-9 <= incident.began + kMoment) chosen = &each;
  }
  return *chosen;
}

void add_recording(const std::filesystem::path& folder, const RuleSet& rules,
                   PageContent& content) {
  const auto own = recordings_of(content.incident, recorder::recordings_in(folder));
  for (const recorder::StoredRecording& each : own)
    content.recordings.push_back(each.path.filename().string());
  if (own.empty()) {
    content.remarks.push_back(
        "There is no recording of it in " + folder.string() +
        ", so there are no plots here. culprit run --record makes one of each incident.");
    return;
  }
  const recorder::StoredRecording& recording = main_recording(own, content.incident);
  auto curves = recorded_curves(
      recording.path, {rules, content.incident.rules, concerned(content.incident, rules)});
  if (!curves) {
    content.remarks.push_back("There are no plots here: " + curves.error() + ".");
    return;
  }
  content.curves = std::move(*curves);
  content.remarks.push_back("The plots are from " + recording.path.filename().string() + ".");
}

}  // namespace

std::optional<double> began_by_id(const std::string& id) {
  std::uint64_t milliseconds = 0;
  constexpr std::size_t kSuffix =
      4;  // "-0k7", of those that a manager told (incidents/incidents.h)
  const std::size_t dash = id.find('-');
  const bool has_suffix = dash != std::string::npos;
  if (has_suffix &&
      (id.size() != dash + kSuffix || !std::ranges::all_of(id.substr(dash + 1), is_digit_of_id)))
    return std::nullopt;
  const char* end = id.data() + (has_suffix ? dash : id.size());
  constexpr int kBase = 36;
  const auto read = std::from_chars(id.data(), end, milliseconds, kBase);
  constexpr std::uint64_t kYear2100 = 4'102'444'800'000;  // ms
  if (read.ec != std::errc() || read.ptr != end || milliseconds >= kYear2100) return std::nullopt;
  return static_cast<double>(milliseconds) / 1000;
}

Expected<std::optional<PageContent>> report_of(const journal::Reader& journal,
                                               const std::string& id,
                                               const std::filesystem::path& recordings,
                                               double now) {
  const auto incident = incident_named(journal, id);
  if (!incident) return Error{incident.error()};
  if (!*incident) return std::optional<PageContent>();
  PageContent content;
  content.incident = **incident;
  content.written_at = now;
  auto told = events_of(journal, content.incident.first_row, content.incident.last_row);
  if (!told) return Error{told.error()};
  for (ToldEvent& each : *told) content.events.push_back(to_json(std::move(each)));
  auto requests = requests_of(journal, content.incident.first_row, content.incident.last_row);
  if (!requests) return Error{requests.error()};
  content.requests = std::move(*requests);
  const auto session = session_at(journal, content.incident.first_row);
  if (!session) return Error{session.error()};
  std::optional<RuleSet> rules;
  if (*session) {
    content.robot = (*session)->robot;
    rules = check(Source((*session)->rules_path, (*session)->rules_text)).rules;
  }
  add_recording(recordings, rules ? *rules : RuleSet(), content);
  return std::optional(std::move(content));
}

}  // namespace culprit::incident_reports
