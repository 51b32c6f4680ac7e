#include "incident_reports/evidence_part.h"

#include <algorithm>
#include <set>

#include <fmt/core.h>

#include "base/xml.h"
#include "incident_reports/incident_words.h"
#include "incident_reports/page_parts.h"
#include "journal/json.h"
#include "knowledge/event.h"

namespace culprit::incident_reports {
namespace {

constexpr std::size_t kMostOnsets = 60;
constexpr double kMostBefore = 60;  // s: what began earlier stands at the beginning of the axis
constexpr double kWide = 300;
constexpr double kHigh = 16;
constexpr double kDot = 5;

bool is_answer(const Json& evidence) {
  return journal::text_of(evidence, "source") == to_string(EvidenceSource::kAnswer);
}

struct OnsetRow {
  double at = 0;  // seconds since 1970
  std::string who{};
  std::string text{};
  const char* look = "for";  // or "against"; of a rule its criticality
};

std::vector<OnsetRow> rows_of_events(const std::vector<Json>& events) {
  std::vector<OnsetRow> rows;
  std::set<std::pair<std::string, std::string>> known;
  for (const Json& event : events) {
    if (journal::text_of(event, "type") == "failure_detected")
      rows.push_back(
          {clock_of(event), journal::text_of(event, "rule"), "detected", criticality_class(event)});
    for (const Json& suspect : list_in(event, "suspects")) {
      const std::string who = journal::text_of(suspect, "component");
      for (const Json& each : list_in(suspect, "evidence")) {
        const std::int64_t age = journal::integer_of(each, "age_ns", -1);
        const std::string text = journal::text_of(each, "text");
        if (age < 0 || is_answer(each) || !known.emplace(who, text).second) continue;
        rows.push_back({clock_of(event) - 1e-9 * static_cast<double>(age), who, text,
                        journal::number_of(each, "log_odds") < 0 ? "against" : "for"});
      }
    }
  }
  if (known.empty()) return {};
  std::ranges::stable_sort(rows, {}, &OnsetRow::at);
  if (rows.size() > kMostOnsets) rows.resize(kMostOnsets);
  return rows;
}

std::string dot_at(const OnsetRow& row, double begin, double end) {
  const double share = std::clamp((row.at - begin) / std::max(1e-3, end - begin), 0.0, 1.0);
  const double x = kDot + share * (kWide - 2 * kDot);
  return fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" aria-hidden=\"true\"><line x1=\"{2:.1f}\" x2=\"{0}\" "
      "y1=\"{3}\" y2=\"{3}\"/><circle class=\"{4}\" cx=\"{2:.1f}\" cy=\"{3}\" r=\"{5}\"/></svg>",
      kWide, kHigh, x, kHigh / 2, row.look, kDot);
}

}  // namespace

std::string onsets_of(const std::vector<Json>& events, double end) {
  const std::vector<OnsetRow> rows = rows_of_events(events);
  if (rows.empty()) return "";
  const auto first = std::ranges::find_if(
      rows, [&](const OnsetRow& row) { return row.at >= rows.back().at - kMostBefore; });
  const double begin = first->at;
  std::string cells;
  for (const OnsetRow& row : rows)
    cells += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"onset\">{}</td></tr>\n",
                         on_clock(row.at), xml_escaped(row.who), xml_escaped(row.text),
                         dot_at(row, begin, std::max(end, rows.back().at)));
  return "<h2>What began first</h2>\n"
         "<p class=\"note\">Filled: a failure, or evidence for a cause. Hollow: evidence against "
         "it.</p>\n" +
         table_of(
             {"from", "component or rule", "what culprit saw",
              fmt::format("{} to {}", on_clock(begin), on_clock(std::max(end, rows.back().at)))},
             cells);
}

std::string evidence_of(const Json& decision) {
  std::string rows;
  std::string answers;
  std::string hinges;
  for (const Json& suspect : list_in(decision, "suspects")) {
    for (const Json& each : list_in(suspect, "evidence")) {
      const std::int64_t age = journal::integer_of(each, "age_ns", -1);
      const std::string when =
          age < 0 ? "" : lasting_text(1e-9 * static_cast<double>(age)) + " before";
      if (is_answer(each)) {
        answers += row_of({safe_text(each, "text"), when});
        continue;
      }
      rows += row_of({safe_text(suspect, "component"), safe_text(each, "text"), when,
                      safe_text(each, "source"),
                      fmt::format("{:+.1f}", journal::number_of(each, "log_odds"))});
      if (const std::string without = safe_text(each, "without"); !without.empty())
        hinges += "<p>Without “" + safe_text(each, "text") + "”, <b>" + without +
                  "</b> would be held responsible.</p>\n";
    }
  }
  std::string out;
  if (!rows.empty()) out += table_of({"suspect", "evidence", "since", "source", "log-odds"}, rows);
  if (!answers.empty()) out += table_of({"asked and answered", "when"}, answers);
  return out + hinges;
}

}  // namespace culprit::incident_reports
