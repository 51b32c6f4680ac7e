#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <set>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/mutex.h"
#include "base/text_file.h"
#include "incident_reports/incident_json.h"
#include "incident_reports/incident_reader.h"
#include "incident_reports/incident_report.h"
#include "recorder/recording_folder.h"
#include "web/aside.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

Json to_json(const std::vector<incident_reports::Incident>& all,
             const std::filesystem::path& folder) {
  const auto recordings =
      folder.empty() ? std::vector<recorder::StoredRecording>() : recorder::recordings_in(folder);
  Json list = Json::array();
  for (const incident_reports::Incident& incident : all)
    list.push_back(
        incident_reports::to_json(incident, incident_reports::recordings_of(incident, recordings)));
  return list;
}

// A number behind the '?' of an address.
template <class Number>
std::optional<Number> number_of(const Json& query, const char* name) {
  const auto text = http::text_of(query, name);
  Number number{};
  if (!text) return std::nullopt;
  const char* end = text->data() + text->size();
  const auto read = std::from_chars(text->data(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return number;
}

// The incidents that are still in the stream.
class Recent {
 public:
  explicit Recent(http::Hub& hub) {
    if (const auto robot = hub.latest(http::Kind::kRobot)) robot_ = parse_json(*robot);
    std::uint64_t seen = 0;
    for (auto batch = hub.wait(seen, std::chrono::milliseconds(0)); !batch.messages.empty();
         batch = hub.wait(seen, std::chrono::milliseconds(0))) {
      seen = batch.messages.back().number;
      for (const http::Message& message : batch.messages) {
        if (message.kind == http::Kind::kEvent)
          events_.emplace_back(message.number, parse_json(*message.data));
      }
    }
  }
  std::vector<incident_reports::Incident> incidents() const {
    incident_reports::IncidentReader reader;
    for (const auto& [number, event] : events_) {
      const double wall = event.value("clock", 0.0);
      if (http::text_of(event, "type") == "reloaded") reader.cut(wall);
      reader.add({static_cast<std::int64_t>(number), wall, event.value("t", 0.0), event});
    }
    std::vector<incident_reports::Incident> all = reader.incidents();
    std::ranges::stable_sort(all, incident_reports::comes_before);
    return all;
  }
  std::string robot() const { return http::text_of(robot_, "robot").value_or(""); }
  Json events(std::int64_t first, std::int64_t last) const {
    Json list = Json::array();
    for (const auto& [number, event] : events_) {
      if (static_cast<std::int64_t>(number) < first || static_cast<std::int64_t>(number) > last)
        continue;
      if (http::text_of(event, "text").value_or("").empty()) continue;
      list.push_back(event);
      list.back()["t"] = event.value("clock", 0.0);
    }
    return list;
  }

 private:
  Json robot_ = Json::object();
  std::vector<std::pair<std::uint64_t, Json>> events_;
};

// Ids of incidents that are open now, according to the latest events.
std::set<std::string> open_now(http::Hub& hub) {
  std::set<std::string> open;
  const auto state = hub.latest(http::Kind::kState);
  if (!state) return open;
  for (const Json& each : parse_json(*state).value("incidents", Json::array()))
    open.insert(http::text_of(each, "id").value_or(""));
  return open;
}

http::Answer list(http::Hub& hub, const std::filesystem::path& path,
                  const std::filesystem::path& recordings, const Json& query) {
  const auto since = number_of<double>(query, "since");
  if (!since || !std::isfinite(*since) || *since < 0)
    return http::refuse(400, "say from when on, in seconds since 1970: ?since=1800000000");
  std::string why = "no journal is written";
  if (!path.empty()) {
    const auto journal = journal::Reader::open(path);
    const auto found = journal ? incident_reports::incidents_of(*journal, *since, open_now(hub))
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

http::Answer events(http::Hub& hub, const std::filesystem::path& path, const Json& query) {
  const auto first = number_of<std::int64_t>(query, "first");
  const auto last = number_of<std::int64_t>(query, "last");
  if (!first || !last)
    return http::refuse(400, "name one, as listed by GET /api/incidents: ?first=17&last=42");
  if (http::text_of(query, "from") == "stream")
    return {200, {{"events", Recent(hub).events(*first, *last)}}};
  if (path.empty()) return http::refuse(404, "no journal is written");
  const auto journal = journal::Reader::open(path);
  if (!journal) return http::refuse(503, journal.error());
  auto told = incident_reports::events_of(*journal, *first, *last);
  if (!told) return http::refuse(503, told.error());
  Json list = Json::array();
  for (incident_reports::ToldEvent& each : *told)
    list.push_back(incident_reports::to_json(std::move(each)));
  return {200, {{"events", list}}};
}

http::Answer as_page(std::string html) {
  http::Answer answer;
  answer.text = {"text/html; charset=utf-8", std::move(html),
                 "default-src 'none'; style-src 'unsafe-inline'"};
  return answer;
}

constexpr const char* kNoSuchIncident =
    "there is no such incident any more; GET /api/incidents lists the existing ones";

http::Answer page_of_stream(http::Hub& hub, const std::string& id) {
  constexpr double kNanosecond = 1e-9;
  const Recent recent(hub);
  for (const incident_reports::Incident& incident : recent.incidents()) {
    if (incident.id != id) continue;
    incident_reports::PageContent content;
    content.incident = incident;
    content.robot = recent.robot();
    for (const Json& event : recent.events(incident.first_row, incident.last_row))
      content.events.push_back(event);
    content.remarks.emplace_back(
        "There are no plots here: they need a journal, and none is written.");
    content.written_at = kNanosecond * static_cast<double>(wall_now());
    if (!incident.is_over)
      content.incident.seconds = std::max(incident.seconds, content.written_at - incident.began);
    return as_page(incident_reports::incident_page(content));
  }
  return http::refuse(404, kNoSuchIncident);
}

// Recordings are large: a process of its own reads them, one at a time.
http::Answer page(http::Hub& hub, const std::filesystem::path& journal,
                  const std::filesystem::path& recordings, Mutex& making, const Json& query) {
  constexpr int kMostSecondsOfPage = 60;
  const auto id = http::text_of(query, "id");
  if (!id || !incident_reports::began_by_id(*id))
    return http::refuse(400, "name one, as listed by GET /api/incidents: ?id=...");
  if (journal.empty() || http::text_of(query, "from") == "stream") return page_of_stream(hub, *id);
  if (!making.try_lock())
    return http::refuse(409, "another page is being made; ask again in a moment");
  const MutexLock lock(making, std::adopt_lock);
  const auto folder = TemporaryFolder::make("aside");
  if (!folder) return http::refuse(503, folder.error());
  const std::string file = *folder / "incident.html";
  std::vector<std::string> command = {(own_folder() / "culprit").string(),
                                      "incident",
                                      *id,
                                      "--journal",
                                      journal.string(),
                                      "-o",
                                      file};
  if (!recordings.empty()) command.insert(command.end(), {"--record-folder", recordings.string()});
  const auto made = run_aside(std::move(command), *folder, kMostSecondsOfPage);
  if (!made) return http::refuse(503, "the page could not be made: " + made.error());
  if (made->status != 0) return http::refuse(404, made->text);
  auto html = read_text(file);
  return html ? as_page(std::move(*html)) : http::refuse(503, html.error());
}

// The requested name is only compared with existing files, and never becomes part of a path.
http::Answer recording(const std::filesystem::path& folder, const Json& query) {
  const auto name = http::text_of(query, "name");
  if (!name) return http::refuse(400, "name one, as listed by GET /api/incidents: ?name=...");
  for (const recorder::StoredRecording& each : recorder::recordings_in(folder)) {
    if (each.path.filename() == *name)
      return {
          200, {}, {}, http::Answer::File{each.path.string(), "application/octet-stream", *name}};
  }
  return http::refuse(404, "there is no such recording, or it had to go for newer ones");
}

}  // namespace

std::vector<http::Route> incident_routes(http::Hub& hub, std::filesystem::path journal,
                                         std::filesystem::path recordings) {
  // A journal of some hundred megabytes takes seconds to read, and any user of this computer may look.
  const auto few = std::make_shared<FewAtOnce>();
  return {{http::Method::kGet, "/api/incidents",
           [&hub, journal, recordings, few](const Json& query) {
             return few->make([&] { return list(hub, journal, recordings, query); });
           }},
          {http::Method::kGet, "/api/incidents/events",
           [&hub, journal, few](const Json& query) {
             return few->make([&] { return events(hub, journal, query); });
           }},
          {http::Method::kGet, "/api/incidents/page",
           [&hub, journal, recordings, making = std::make_shared<Mutex>()](const Json& query) {
             return page(hub, journal, recordings, *making, query);
           }},
          {http::Method::kGet, "/api/incidents/recording",
           [recordings](const Json& query) { return recording(recordings, query); }}};
}

}  // namespace culprit::web
