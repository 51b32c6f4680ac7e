#include <cmath>
#include <cstdlib>
#include <memory>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/mutex.h"
#include "replay/curves.h"
#include "web/aside.h"
#include "web/calls.h"
#include "web/replay_of_curves.h"

namespace culprit::web {
namespace {

// "processor camera", "memory camera"; otherwise a signal.
Series series_of(const std::string& name, const Histories& histories) {
  const auto space = name.find(' ');
  const std::string what = name.substr(0, space);
  if (space == std::string::npos || (what != "processor" && what != "memory"))
    return histories.signals.of(name);
  Series series;
  for (const UsageHistory::Usage& look : histories.usage.day_of(name.substr(space + 1))) {
    series.clocks.push_back(look.clock);
    series.values.push_back(what == "memory" ? static_cast<double>(look.memory) : look.processor);
  }
  return series;
}

http::Answer answer_series(const Json& query, const Histories& histories) {
  const auto name = http::text_of(query, "name");
  if (!name) return http::refuse(400, "say which: ?name=rate /scan");
  const double since = std::atof(http::text_of(query, "since").value_or("0").c_str());
  const Series series = series_of(*name, histories);
  Json json{{"clocks", Json::array()}, {"values", Json::array()}};
  for (std::size_t i = 0; i < series.clocks.size(); ++i) {
    if (series.clocks[i] <= since) continue;
    json["clocks"].push_back(std::round(series.clocks[i] * 1e3) / 1e3);
    json["values"].push_back(std::isfinite(series.values[i]) ? Json(series.values[i]) : Json());
  }
  return {200, std::move(json)};
}

constexpr double kMostPast = 30 * 86'400;  // s
constexpr int kMostSecondsOfCurves = 60;
constexpr std::size_t kMostNames = 24;

// Since when there are curves, and why not for longer.
Json reach_of(const std::filesystem::path& journal) {
  constexpr double kNanosecond = 1e-9;
  std::string why = "no journal is written";
  if (!journal.empty()) {
    const auto reader = journal::Reader::open(journal);
    const auto oldest = reader ? replay::oldest_curve(*reader) : Error{reader.error()};
    if (oldest && *oldest)
      return {{"oldest", kNanosecond * static_cast<double>(**oldest)},
              {"why", "the journal begins then"}};
    why = oldest ? "the journal has no run" : oldest.error();
  }
  return {{"oldest", nullptr}, {"why", why}};
}

std::optional<std::vector<std::string>> names_in(const Json& body) {
  const auto list = body.is_object() ? body.find("names") : body.end();
  if (!body.is_object() || list == body.end() || !list->is_array() || list->size() > kMostNames)
    return std::nullopt;
  std::vector<std::string> names;
  for (const Json& each : *list) {
    if (!each.is_string()) return std::nullopt;
    names.push_back(each.get<std::string>());
  }
  return names;
}

http::Answer answer_past(const Json& body, const std::filesystem::path& journal, Mutex& replaying) {
  const auto names = names_in(body);
  if (!names) return http::refuse(400, "send at most 24 'names' of curves, and 'from' and 'to'");
  Json reach = reach_of(journal);
  if (names->empty() || reach["oldest"].is_null()) return {200, std::move(reach)};
  const double now = 1e-9 * static_cast<double>(wall_now());
  const double from = body.value("from", 0.0);
  const double to = body.value("to", 0.0);
  if (!(from < to) || !(now - from <= kMostPast) || !(from <= now))
    return http::refuse(400, "say 'from' and 'to' in seconds since 1970, a month back at most");
  if (!replaying.try_lock())
    return http::refuse(409, "another replay is going on; ask again in a moment");
  const MutexLock lock(replaying, std::adopt_lock);
  std::vector<std::string> command =
      replay_of_curves(own_folder() / "culprit", journal, now - from, now - to, *names);
  const auto folder = TemporaryFolder::make("aside");
  if (!folder) return http::refuse(503, folder.error());
  const auto read = run_aside(std::move(command), *folder, kMostSecondsOfCurves);
  if (!read) return http::refuse(503, "the journal could not be replayed: " + read.error());
  if (read->status != 0) return http::refuse(404, read->text);
  Json curves = parse_json(read->text);
  if (!curves.is_object()) return http::refuse(503, "the replay gave nothing: " + read->text);
  curves.update(reach);
  return {200, std::move(curves)};
}

}  // namespace

http::Route past_series_route(std::filesystem::path journal) {
  return {http::Method::kPost, "/api/series/past",
          [journal = std::move(journal), replaying = std::make_shared<Mutex>()](const Json& body) {
            return answer_past(body, journal, *replaying);
          },
          http::Role::kLook};
}

http::Route series_route(const Histories& histories) {
  return {http::Method::kGet, "/api/series",
          [&histories](const Json& query) { return answer_series(query, histories); }};
}

}  // namespace culprit::web
