#include "web/incident_routes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "incidents/journal_incidents.h"
#include "knowledge/describe.h"
#include "recorder/recording_folder.h"

namespace culprit::web {
namespace {

using incidents::Incident;

Json to_json(const Incident& incident) {
  return {{"id", incident.id()},
          {"first", incident.first_row},
          {"last", incident.last_row},
          {"clock", std::round(incident.began * 1000) / 1000},
          {"seconds", std::round(incident.seconds * 1000) / 1000},
          {"over", incident.is_over},
          {"cut", incident.is_cut},
          {"given_up", incident.is_given_up},
          {"worst", culprit::to_string(incident.worst)},
          {"causes", incident.causes},
          {"rules", incident.rules},
          {"consequences", incident.consequences},
          {"helped", incident.helped}};
}

// Those that were written while it lasted, or were begun then.
Json recordings_of(const Incident& incident,
                   const std::vector<recorder::StoredRecording>& recordings) {
  constexpr double kMargin = 2;  // s: between what begins an incident and what begins its recording
  constexpr double kNanosecond = 1e-9;
  Json list = Json::array();
  for (const recorder::StoredRecording& each : recordings) {
    const bool is_later = incident.is_over && static_cast<double>(each.when) * kNanosecond >
                                                  incident.began + incident.seconds + kMargin;
    const bool is_earlier =
        static_cast<double>(std::max(each.when, each.ended)) * kNanosecond + kMargin <
        incident.began;
    if (is_later || is_earlier) continue;
    list.push_back({{"name", each.path.filename().string()},
                    {"path", each.path.string()},
                    {"bytes", each.bytes}});
  }
  return list;
}

Json to_json(const std::vector<Incident>& all, const std::filesystem::path& folder) {
  const auto recordings =
      folder.empty() ? std::vector<recorder::StoredRecording>() : recorder::recordings_in(folder);
  Json list = Json::array();
  for (const Incident& incident : all) {
    list.push_back(to_json(incident));
    list.back()["recordings"] = recordings_of(incident, recordings);
  }
  return list;
}

// A number behind the '?' of an address.
template <class Number>
std::optional<Number> number_of(const Json& query, const char* name) {
  const auto text = text_of(query, name);
  Number number{};
  if (!text) return std::nullopt;
  const char* end = text->data() + text->size();
  const auto read = std::from_chars(text->data(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return number;
}

// Candidates as the stream tells them (event_json.h): the journal has a word and a sentence.
void tell_exclusions(Json& event) {
  const auto candidates = event.find("candidates");
  if (candidates == event.end() || !candidates->is_array()) return;
  for (Json& candidate : *candidates) {
    if (!candidate.is_object()) continue;
    const auto condition = text_of(candidate, "excluded");
    candidate["excluded"] = nullptr;
    if (condition)
      candidate["excluded"] = {{"condition", *condition},
                               {"text", text_of(candidate, "because").value_or("")}};
    candidate.erase("because");
  }
}

Json to_json(incidents::ToldEvent& told) {
  const double wall = std::round(told.wall * 1e6) / 1e6;
  Json json{{"t", wall}, {"clock", wall}};
  const auto type = text_of(told.event, "type");
  if (const auto kind = kind_named(type.value_or(""))) json.update(web::to_json(words_of(*kind)));
  if (text_of(told.event, "criticality") == "ERROR") json["severity"] = "error";
  told.event.erase("time");
  json.update(told.event);
  if (!told.components.empty()) json["components"] = told.components;
  tell_exclusions(json);
  return json;
}

// Of what the stream still has.
class Recent {
 public:
  explicit Recent(Hub& hub) {
    if (const auto robot = hub.latest(Kind::kRobot)) robot_ = Json::parse(*robot);
    std::uint64_t seen = 0;
    for (auto batch = hub.wait(seen, std::chrono::milliseconds(0)); !batch.messages.empty();
         batch = hub.wait(seen, std::chrono::milliseconds(0))) {
      seen = batch.messages.back().number;
      for (const Message& message : batch.messages) {
        if (message.kind == Kind::kEvent)
          events_.emplace_back(message.number, Json::parse(*message.data));
      }
    }
  }
  std::vector<Incident> incidents() const {
    incidents::IncidentBuilder builder;
    const auto components_of = [this](const std::string& rule, const std::string& strategy) {
      return this->components_of(rule, strategy);
    };
    for (const auto& [number, event] : events_) {
      if (text_of(event, "type") == "reloaded") builder.cut();
      builder.add({static_cast<std::int64_t>(number), event.value("clock", 0.0),
                   event.value("t", 0.0), event},
                  components_of);
    }
    return builder.incidents();
  }
  Json events(std::int64_t first, std::int64_t last) const {
    Json list = Json::array();
    for (const auto& [number, event] : events_) {
      if (static_cast<std::int64_t>(number) < first || static_cast<std::int64_t>(number) > last)
        continue;
      list.push_back(event);
      list.back()["t"] = event.value("clock", 0.0);
    }
    return list;
  }

 private:
  std::vector<std::string> components_of(const std::string& rule,
                                         const std::string& strategy) const {
    for (const Json& each : robot_.value("rules", Json::array())) {
      if (each["name"] != rule) continue;
      if (strategy.empty()) return each["components"];
      for (const Json& own : each["strategies"]) {
        if (own["name"] == strategy) return own["components"];
      }
    }
    return {};
  }

  Json robot_ = Json::object();
  std::vector<std::pair<std::uint64_t, Json>> events_;
};

// Rules that see a failure now, as far as somebody told.
std::set<std::string> failing_now(Hub& hub) {
  std::set<std::string> failing;
  const auto robot = hub.latest(Kind::kRobot);
  const auto state = hub.latest(Kind::kState);
  if (!robot || !state) return failing;
  const Json rules = Json::parse(*robot)["rules"];
  const Json states = Json::parse(*state)["rules"];
  for (std::size_t r = 0; r < std::min(rules.size(), states.size()); ++r) {
    if (states[r]["phase"] != "quiet") failing.insert(rules[r]["name"].get<std::string>());
  }
  return failing;
}

Answer list(Hub& hub, const std::filesystem::path& path, const std::filesystem::path& recordings,
            const Json& query) {
  const auto since = number_of<double>(query, "since");
  if (!since || !std::isfinite(*since) || *since < 0)
    return refuse(400, "say from when on, in seconds since 1970: ?since=1800000000");
  std::string why = "no journal is written";
  if (!path.empty()) {
    const auto journal = journal::Reader::open(path);
    const auto found = journal ? incidents::incidents_of(*journal, *since, failing_now(hub))
                               : Error{journal.error()};
    if (found)
      return {200,
              {{"journal", path.string()},
               {"oldest", found->oldest},
               {"incidents", to_json(found->incidents, recordings)}}};
    why = found.error();
  }
  return {200,
          {{"journal", nullptr},
           {"remark", why},
           {"incidents", to_json(Recent(hub).incidents(), recordings)}}};
}

Answer events(Hub& hub, const std::filesystem::path& path, const Json& query) {
  const auto first = number_of<std::int64_t>(query, "first");
  const auto last = number_of<std::int64_t>(query, "last");
  if (!first || !last)
    return refuse(400, "say which, as GET /api/incidents tells them: ?first=17&last=42");
  if (text_of(query, "from") == "stream")
    return {200, {{"events", Recent(hub).events(*first, *last)}}};
  if (path.empty()) return refuse(404, "no journal is written");
  const auto journal = journal::Reader::open(path);
  if (!journal) return refuse(503, journal.error());
  auto told = incidents::events_of(*journal, *first, *last);
  if (!told) return refuse(503, told.error());
  Json list = Json::array();
  for (incidents::ToldEvent& each : *told) list.push_back(to_json(each));
  return {200, {{"events", list}}};
}

// What is asked for is compared with what is there, and never becomes part of a path.
Answer recording(const std::filesystem::path& folder, const Json& query) {
  const auto name = text_of(query, "name");
  if (!name) return refuse(400, "say which, as GET /api/incidents tells them: ?name=...");
  for (const recorder::StoredRecording& each : recorder::recordings_in(folder)) {
    if (each.path.filename() == *name)
      return {200, {}, {}, Answer::File{each.path.string(), "application/octet-stream", *name}};
  }
  return refuse(404, "there is no such recording, or it had to go for newer ones");
}

}  // namespace

std::vector<Route> incident_routes(Hub& hub, std::filesystem::path journal,
                                   std::filesystem::path recordings) {
  return {{Method::kGet, "/api/incidents",
           [&hub, journal, recordings](const Json& query) {
             return list(hub, journal, recordings, query);
           }},
          {Method::kGet, "/api/incidents/events",
           [&hub, journal](const Json& query) { return events(hub, journal, query); }},
          {Method::kGet, "/api/incidents/recording",
           [recordings](const Json& query) { return recording(recordings, query); }}};
}

}  // namespace culprit::web
