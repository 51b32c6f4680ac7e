#include "drill/drill_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/duration_words.h"
#include "base/xml.h"

namespace culprit::drill {
namespace {

using Row = std::vector<std::string>;

// A section of the report: text and page show the same.
struct Section {
  std::string title;
  Row heads;
  std::vector<Row> rows;
};

std::string in_seconds(double time) { return fmt::format("{:.2f} s", time); }

// "0.41 s, 0.52 s at most"
std::string spread_text(const std::vector<double>& numbers) {
  const Spread spread = spread_of(numbers);
  if (spread.count == 0) return "-";
  return spread.count == 1 ? in_seconds(spread.median)
                           : in_seconds(spread.median) + ", at most " + in_seconds(spread.most);
}

std::string counts_text(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name, count);
  return text.empty() ? "-" : text;
}

std::string joined(const auto& items) {
  std::string text;
  for (const std::string& each : items) text += (text.empty() ? "" : ", ") + each;
  return text;
}

Section faults_section(const Results& results) {
  Section out{"Faults",
              {"fault", "noticed", "after", "first rule", "blamed rightly", "helped", "well",
               "well after", "also silent"},
              {}};
  for (const FaultResult& each : results.faults) {
    const int blamed = each.blamed_rightly + each.blamed_wrongly;
    out.rows.push_back({each.fault, fmt::format("{} of {}", each.noticed, each.times),
                        spread_text(each.noticed_after), counts_text(each.first_rule),
                        blamed == 0 ? "-" : fmt::format("{} of {}", each.blamed_rightly, blamed),
                        counts_text(each.helped), fmt::format("{} of {}", each.well, each.times),
                        spread_text(each.well_after), counts_text(each.silent)});
  }
  return out;
}

std::string impact_text(const StrategyResult& each, Duration cycle) {
  return each.effects.empty() ? "-" : std::to_string(impact_of(each.effects, cycle));
}

Section strategies_section(const Results& results) {
  Section out{"Strategies",
              {"strategy", "helped", "measured", "95 % interval", "file: probability", "confidence",
               "measured impact", "file: impact"},
              {}};
  for (const StrategyResult& each : results.strategies) {
    const Interval interval = interval_of(each.helped, each.tried);
    out.rows.push_back(
        {each.rule + "." + each.strategy, fmt::format("{} of {}", each.helped, each.tried),
         each.tried == 0 ? "-" : fmt::format("{:.0f} %", 100.0 * each.helped / each.tried),
         each.tried == 0
             ? "-"
             : fmt::format("{:.0f} to {:.0f} %", 100 * interval.low, 100 * interval.high),
         fmt::format("{:g} %", each.probability), fmt::format("{:g}", each.confidence),
         impact_text(each, results.cycle), std::to_string(each.impact)});
  }
  return out;
}

std::string value_text(const ThresholdMeasure& each, std::optional<double> value) {
  if (!value) return "-";
  return each.of.is_duration ? in_words(from_seconds(*value)) : fmt::format("{:.3g}", *value);
}

Section thresholds_section(const std::vector<ThresholdMeasure>& thresholds) {
  Section out{"Thresholds",
              {"rule", "value", "healthy", "values", "faulty", "file", "proposed",
               "beyond the healthy, at most an hour", "FOR at least"},
              {}};
  for (const ThresholdMeasure& each : thresholds) {
    const bool is_known = each.values > 0;
    std::string value = each.of.subject;
    if (each.of.what != Comparison::What::kSignal)
      value = (each.of.what == Comparison::What::kAge ? "age(" : "rate(") + value + ")";
    out.rows.push_back(
        {each.of.rule, value + (each.of.is_above ? " >" : " <"),
         is_known ? value_text(each, each.least) + " to " + value_text(each, each.most) : "-",
         std::to_string(each.values), value_text(each, each.faulty),
         value_text(each, each.of.threshold), value_text(each, each.proposed()),
         is_known ? fmt::format("{:.3g}", each.most_an_hour()) : "-",
         each.longest_beyond > 0 ? in_words(from_seconds(2 * each.longest_beyond)) : "-"});
  }
  return out;
}

Section starts_section(const Results& results) {
  Section out{
      "Starts", {"component", "starts", "until it was up", "READY at least", "file: READY"}, {}};
  for (const auto& [component, times] : results.starts) {
    const auto ready = results.ready.find(component);
    out.rows.push_back({component, std::to_string(times.size()), spread_text(times),
                        fmt::format("{}s", ready_of(times).count()),
                        ready == results.ready.end() ? "-" : in_words(ready->second)});
  }
  return out;
}

Section coverage_section(const Results& results) {
  Section out{"Coverage", {"what", "which"}, {}};
  const auto add = [&](const char* what, const std::string& which) {
    out.rows.push_back({what, which.empty() ? "none" : which});
  };
  add("faults that no rule notices", joined(results.unnoticed));
  add("rules that no fault trips", joined(results.untripped));
  add("strategies that never helped", joined(results.never_helped));
  add("healthy components that were adapted",
      results.touched.empty() ? "" : counts_text(results.touched));
  std::vector<std::string> hidden;
  for (const HiddenDependency& each : results.hidden)
    hidden.push_back(fmt::format("{} on {} ({} times)", each.consumer, each.producer, each.times));
  add("dependencies that the graph does not show", joined(hidden));
  for (const FaultResult& each : results.faults)
    for (const std::string& text : each.evidence) add("wrong blame", text);
  for (const std::string& text : results.spoilt) add("proves nothing", text);
  return out;
}

std::vector<Section> sections_of(const Results& results) {
  std::vector<Section> all{faults_section(results), coverage_section(results),
                           strategies_section(results)};
  if (!results.thresholds.empty()) all.push_back(thresholds_section(results.thresholds));
  if (!results.starts.empty()) all.push_back(starts_section(results));
  return all;
}

void add_lines(const Section& section, std::vector<std::string>& lines) {
  std::vector<std::size_t> widths;
  for (const std::string& head : section.heads) widths.push_back(head.size());
  for (const Row& row : section.rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  const auto line = [&](const Row& row) {
    std::string text = " ";
    for (std::size_t i = 0; i < row.size(); ++i)
      text += i + 1 == row.size() ? " " + row[i] : fmt::format(" {:<{}} ", row[i], widths[i]);
    return text;
  };
  lines.push_back(section.title);
  lines.push_back(line(section.heads));
  for (const Row& row : section.rows) lines.push_back(line(row));
}

Json spread_json(const std::vector<double>& numbers) {
  const Spread spread = spread_of(numbers);
  if (spread.count == 0) return nullptr;
  return {{"median_s", spread.median}, {"most_s", spread.most}};
}

Json maybe(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

}  // namespace

std::string line_of(const Trial& trial) {
  std::string text = to_string(trial.faults) + ": ";
  if (!trial.trouble.empty()) return text + "proves nothing, " + trial.trouble;
  const Finding finding = finding_of(trial);
  text += finding.noticed_after
              ? "noticed after " + in_seconds(*finding.noticed_after) + " by " + finding.rule
              : "not noticed";
  if (!finding.wrongly.empty()) text += ", WRONGLY BLAMED " + joined(finding.wrongly);
  if (!finding.helped.empty()) text += ", helped by " + joined(finding.helped);
  const bool heals_itself = trial.faults.front().kind == FaultKind::kRestart;
  if (trial.undone && !heals_itself)
    text += ", undone after " + in_seconds(*trial.undone - trial.injected);
  text += finding.well_after ? ", well after " + in_seconds(*finding.well_after) : ", NOT WELL";
  if (!finding.silent.empty()) text += "; also silent: " + joined(finding.silent);
  return text;
}

std::vector<std::string> report_lines(const Results& results) {
  std::vector<std::string> lines;
  for (const Section& section : sections_of(results)) {
    if (!lines.empty()) lines.emplace_back();
    add_lines(section, lines);
  }
  return lines;
}

std::vector<std::string> threshold_lines(const std::vector<ThresholdMeasure>& thresholds) {
  std::vector<std::string> lines;
  add_lines(thresholds_section(thresholds), lines);
  return lines;
}

std::string report_page(const Results& results) {
  const std::string title =
      "Drill of " + (results.robot.empty() ? "the robot" : results.robot) + ", " + results.date;
  std::string page = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>" +
                     xml_escaped(title) +
                     "</title>\n<style>:root{color-scheme:light dark}body{font:15px/1.5 "
                     "system-ui,sans-serif;margin:2rem}table{border-collapse:collapse}td,th{"
                     "text-align:left;vertical-align:top;padding:.2rem .8rem .2rem 0;border-bottom:"
                     "1px solid #8888}</style>\n<h1>" +
                     xml_escaped(title) + "</h1>\n";
  for (const Section& section : sections_of(results)) {
    page += "<h2>" + section.title + "</h2>\n<table><tr>";
    for (const std::string& head : section.heads)
      page += "<th scope=\"col\">" + xml_escaped(head) + "</th>";
    page += "</tr>\n";
    for (const Row& row : section.rows) {
      page += "<tr>";
      for (const std::string& cell : row) page += "<td>" + xml_escaped(cell) + "</td>";
      page += "</tr>\n";
    }
    page += "</table>\n";
  }
  return page + "</html>\n";
}

Json report_json(const Results& results) {
  Json json{{"robot", results.robot},
            {"date", results.date},
            {"faults", Json::array()},
            {"strategies", Json::array()},
            {"thresholds", Json::array()},
            {"coverage",
             {{"unnoticed", results.unnoticed},
              {"untripped", results.untripped},
              {"never_helped", results.never_helped},
              {"touched", results.touched}}},
            {"starts", Json::object()},
            {"hidden_dependencies", Json::array()},
            {"spoilt", results.spoilt}};
  for (const FaultResult& each : results.faults)
    json["faults"].push_back({{"fault", each.fault},
                              {"times", each.times},
                              {"noticed", each.noticed},
                              {"noticed_after", spread_json(each.noticed_after)},
                              {"first_rule", each.first_rule},
                              {"blamed_rightly", each.blamed_rightly},
                              {"blamed_wrongly", each.blamed_wrongly},
                              {"evidence", each.evidence},
                              {"helped", each.helped},
                              {"healed", each.healed},
                              {"well", each.well},
                              {"well_after", spread_json(each.well_after)},
                              {"also_silent", each.silent}});
  for (const StrategyResult& each : results.strategies) {
    const Interval interval = interval_of(each.helped, each.tried);
    Json one{{"rule", each.rule},
             {"strategy", each.strategy},
             {"tried", each.tried},
             {"helped", each.helped},
             {"interval", {interval.low, interval.high}},
             {"file",
              {{"probability", each.probability},
               {"confidence", each.confidence},
               {"impact", each.impact}}}};
    one["impact"] =
        each.effects.empty() ? Json(nullptr) : Json(impact_of(each.effects, results.cycle));
    json["strategies"].push_back(std::move(one));
  }
  for (const ThresholdMeasure& each : results.thresholds)
    json["thresholds"].push_back({{"rule", each.of.rule},
                                  {"subject", each.of.subject},
                                  {"values", each.values},
                                  {"healthy", {each.least, each.most}},
                                  {"faulty", maybe(each.faulty)},
                                  {"file", each.of.threshold},
                                  {"proposed", maybe(each.proposed())},
                                  {"most_an_hour", each.most_an_hour()},
                                  {"longest_beyond_s", each.longest_beyond}});
  for (const auto& [component, times] : results.starts)
    json["starts"][component] = spread_json(times);
  for (const HiddenDependency& each : results.hidden)
    json["hidden_dependencies"].push_back(
        {{"consumer", each.consumer}, {"producer", each.producer}, {"times", each.times}});
  return json;
}

}  // namespace culprit::drill
