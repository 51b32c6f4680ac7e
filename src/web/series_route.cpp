#include <cmath>
#include <cstdlib>

#include "web/calls.h"

namespace culprit::web {
namespace {

// "processor camera", "memory camera"; otherwise a signal.
Series series_of(const std::string& name, const Histories& histories) {
  const auto space = name.find(' ');
  const std::string what = name.substr(0, space);
  if (space == std::string::npos || (what != "processor" && what != "memory"))
    return histories.signals.of(name);
  Series series;
  for (const UsageHistory::Usage& look : histories.usage.of(name.substr(space + 1))) {
    series.clocks.push_back(look.clock);
    series.values.push_back(what == "memory" ? static_cast<double>(look.memory) : look.processor);
  }
  return series;
}

Answer answer_series(const Json& query, const Histories& histories) {
  const auto name = text_of(query, "name");
  if (!name) return refuse(400, "say which: ?name=rate /scan");
  const double since = std::atof(text_of(query, "since").value_or("0").c_str());
  const Series series = series_of(*name, histories);
  Json json{{"clocks", Json::array()}, {"values", Json::array()}};
  for (std::size_t i = 0; i < series.clocks.size(); ++i) {
    if (series.clocks[i] <= since) continue;
    json["clocks"].push_back(std::round(series.clocks[i] * 1e3) / 1e3);
    json["values"].push_back(std::isfinite(series.values[i]) ? Json(series.values[i]) : Json());
  }
  return {200, std::move(json)};
}

}  // namespace

Route series_route(const Histories& histories) {
  return {Method::kGet, "/api/series",
          [&histories](const Json& query) { return answer_series(query, histories); }};
}

}  // namespace culprit::web
