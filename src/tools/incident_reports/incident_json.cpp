#include "incident_reports/incident_json.h"

#include <algorithm>
#include <cmath>

#include "knowledge/describe.h"

namespace culprit::incident_reports {
namespace {

// Candidates as in the stream: the journal has a word and a sentence.
void tell_exclusions(Json& event) {
  const auto candidates = event.find("candidates");
  if (candidates == event.end() || !candidates->is_array()) return;
  for (Json& candidate : *candidates) {
    if (!candidate.is_object()) continue;
    const std::string condition = journal::text_of(candidate, "excluded");
    const std::string because = journal::text_of(candidate, "because");
    candidate["excluded"] = nullptr;
    if (!condition.empty()) candidate["excluded"] = {{"condition", condition}, {"text", because}};
    candidate.erase("because");
    const std::string end = journal::text_of(candidate, "ends");
    if (!end.empty()) candidate["excluded"]["ends"] = end;
    candidate.erase("ends");
  }
}

}  // namespace

std::vector<recorder::StoredRecording> recordings_of(
    const Incident& incident, const std::vector<recorder::StoredRecording>& all) {
  constexpr double kMargin = 2;  // s: between what begins an incident and what begins its recording
  constexpr double kSecondsPerNanosecond = 1e-9;
  std::vector<recorder::StoredRecording> own;
  for (const recorder::StoredRecording& each : all) {
    const double when = static_cast<double>(each.when) * kSecondsPerNanosecond;
    const double ended =
        static_cast<double>(std::max(each.when, each.ended)) * kSecondsPerNanosecond;
    const bool is_later = incident.is_over && when > incident.began + incident.seconds + kMargin;
    const bool is_earlier = ended + kMargin < incident.began;
    if (!is_later && !is_earlier) own.push_back(each);
  }
  return own;
}

Json to_json(const Incident& incident, const std::vector<recorder::StoredRecording>& recordings) {
  Json json{{"id", incident.id},
            {"first", incident.first_row},
            {"last", incident.last_row},
            {"clock", std::round(incident.began * 1000) / 1000},
            {"seconds", std::round(incident.seconds * 1000) / 1000},
            {"over", incident.is_over},
            {"cut", incident.is_cut},
            {"lost", incident.is_lost},
            {"merged_into", incident.merged_into.empty() ? Json() : Json(incident.merged_into)},
            {"given_up", incident.is_given_up},
            {"needs_person", incident.needs_person},
            {"worst", culprit::to_string(incident.worst)},
            {"causes", incident.causes},
            {"rules", incident.rules},
            {"consequences", incident.consequences},
            {"helped", incident.helped},
            {"recordings", Json::array()}};
  for (const recorder::StoredRecording& each : recordings)
    json["recordings"].push_back({{"name", each.path.filename().string()},
                                  {"path", each.path.string()},
                                  {"bytes", each.bytes}});
  return json;
}

Json to_json(const EventWords& words) {
  return {{"type", words.name},
          {"label", words.label},
          {"severity", culprit::to_string(words.severity)},
          {"tone", culprit::to_string(words.tone)}};
}

Json to_json(ToldEvent told) {
  const double wall = std::round(told.wall * 1e6) / 1e6;
  Json json{{"t", wall}, {"clock", wall}};
  if (const auto kind = kind_named(journal::text_of(told.event, "type")))
    json.update(to_json(words_of(*kind)));
  if (journal::text_of(told.event, "criticality") == "ERROR") json["severity"] = "error";
  told.event.erase("time");
  json.update(told.event);
  if (!told.components.empty()) json["components"] = told.components;
  tell_exclusions(json);
  return json;
}

}  // namespace culprit::incident_reports
