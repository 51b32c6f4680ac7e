#include "cli/replay_curves.h"

#include <cmath>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "incident_reports/incident_json.h"
#include "incident_reports/journal_incidents.h"
#include "json/json.h"
#include "replay/curves.h"
#include "terminal/command.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

double rounded(double clock) { return std::round(clock * 1000) / 1000; }

// Failures and repairs of that time, for marks. Errors: the journal cannot be read.
Expected<Json> marks_of(const journal::Reader& journal, std::int64_t since, std::int64_t until) {
  auto rows = journal.entries(journal::Which::kReadable);
  if (!rows) return Error{rows.error()};
  std::int64_t first = 0;
  std::int64_t last = -1;
  journal::Entry row;
  auto more = rows->next(row);
  for (; more && *more && row.at <= until; more = rows->next(row)) {
    if (row.at < since) continue;
    if (first == 0) first = row.id;
    last = row.id;
  }
  if (!more) return Error{more.error()};
  auto told = incident_reports::events_of(journal, first, last);
  if (!told) return Error{told.error()};
  Json marks = Json::array();
  for (incident_reports::ToldEvent& each : *told)
    marks.push_back(incident_reports::to_json(std::move(each)));
  return marks;
}

void print_table(const CurveOptions& options, const replay::Curves& curves) {
  fmt::print("clock_s");
  for (const std::string& name : options.names) fmt::print(",{}", name);
  fmt::print("\n");
  for (std::size_t row = 0; row < curves.clocks.size(); ++row) {
    fmt::print("{:.3f}", curves.clocks[row]);
    for (const auto& column : curves.columns)
      fmt::print(",{}", std::isnan(column[row]) ? "" : fmt::format("{:g}", column[row]));
    fmt::print("\n");
  }
}

void print_curves_document(const CurveOptions& options, const replay::Curves& curves, Json marks) {
  Json json{{"clocks", Json::array()}, {"curves", Json::object()}, {"events", std::move(marks)}};
  for (const double clock : curves.clocks) json["clocks"].push_back(rounded(clock));
  for (std::size_t i = 0; i < options.names.size(); ++i) {
    Json values = Json::array();
    for (const float value : curves.columns[i])
      values.push_back(std::isfinite(value) ? Json(value) : Json());
    json["curves"][options.names[i]] = std::move(values);
  }
  fmt::print("{}\n", to_line(json));
}

}  // namespace

int replay_curves(const CurveOptions& options, const journal::Reader& journal) {
  if (options.since.empty()) return fail("--curve needs --since, such as 2h", kUsage);
  const auto since = duration_of_option("--since", options.since);
  if (!since) return fail(since.error(), kUsage);
  const auto until = options.until.empty() ? Expected<Duration>(Duration::zero())
                                           : duration_of_option("--until", options.until);
  if (!until) return fail(until.error(), kUsage);
  const std::int64_t now = wall_now();
  const replay::CurveWish wish{options.names, now - since->count(), now - until->count()};
  const auto curves = replay::curves_of(journal, wish);
  if (!curves) return fail(curves.error());
  if (!options.json) {
    print_table(options, *curves);
    return kOk;
  }
  auto marks = marks_of(journal, wish.since, wish.until);
  if (!marks) return fail(marks.error());
  print_curves_document(options, *curves, std::move(*marks));
  return kOk;
}

}  // namespace culprit::cli
