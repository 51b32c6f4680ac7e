#include "suave_study/suave_report.h"

#include <algorithm>

#include <fmt/core.h>

#include "json/json.h"
#include "study/statistics/welch.h"
#include "study/tables/columns.h"
#include "suave_study/published.h"
#include "suave_study/suave_record.h"

namespace culprit::study {
namespace {

constexpr const char* kNothing = "–";

struct Test {
  std::string baseline;
  const char* metric;
  const char* title;
  WelchTest result;
};

// culprit against each baseline, over all runs of both.
std::vector<Test> tests(const std::vector<SuaveRow>& rows) {
  std::vector<Test> tests;
  const auto ours = std::find_if(rows.begin(), rows.end(),
                                 [](const SuaveRow& row) { return row.manager == kCulprit; });
  if (ours == rows.end()) return tests;
  for (const SuaveRow& row : rows) {
    if (row.manager == kCulprit) continue;
    const auto put = [&](const char* metric, const char* title, const Moments& theirs,
                         const Moments& own) {
      if (const auto result = welch_test(theirs, own))
        tests.push_back({row.manager, metric, title, *result});
    };
    put("search_time_s", "search [s]", row.searched_s, ours->searched_s);
    put("distance_m", "inspected [m]", row.last_distance_m, ours->last_distance_m);
    put("whole_distance_m", "inspected in all [m]", row.whole_distance_m, ours->whole_distance_m);
  }
  return tests;
}

// ---- tables

std::string mean_sd(const Moments& moments) {
  if (moments.count() == 0) return kNothing;
  return number(moments.mean()) + " ± " + number(moments.sample_sd());
}

std::string mean(const SuaveReactions& reactions) {
  return reactions.answered_s.count() == 0 ? kNothing : number(reactions.answered_s.mean(), 3);
}

std::string mean(const std::optional<double>& seconds) {
  return seconds ? number(*seconds) : kNothing;
}

Table results_table(const SuaveCampaign& campaign, const std::vector<SuaveRow>& rows) {
  Table table{"suave",
              fmt::format("SUAVE, {} mission: mean ± sd", campaign.plan->name),
              {{"", "manager", "", "", Align::kLeft},
               {"", "search [s]"},
               {"", "inspected [m]"},
               {"reaction [s]", "visibility"},
               {"reaction [s]", "thruster"}},
              {},
              {}};
  const bool has_battery = campaign.plan->needs_battery;
  if (has_battery) table.columns.push_back({"reaction [s]", "battery"});
  for (const SuaveRow& row : rows) {
    table.rows.push_back({{row.manager},
                          {mean_sd(row.search_s)},
                          {mean_sd(row.distance_m)},
                          {mean(row.visibility)},
                          {mean(row.thruster)}});
    if (has_battery) table.rows.back().push_back({mean(row.battery)});
    const auto* paper = published::find_suave(campaign.plan->name, row.manager);
    if (paper == nullptr) continue;
    table.rows.push_back({{(row.manager == kCulprit ? "\"Ours\"" : row.manager) + ", paper"},
                          {mean_sd(paper->search_s)},
                          {mean_sd(paper->distance_m)},
                          {mean(paper->visibility_s)},
                          {mean(paper->thruster_s)}});
    if (has_battery) table.rows.back().push_back({mean(paper->battery_s)});
  }
  for (const SuaveRow& row : rows) {
    if (row.manager == kCulprit)
      table.notes.push_back(fmt::format(
          "As in the paper, searches of its own manager above the mean and twice the sd are left "
          "out: {} of {}. All runs: search {} s, inspected {} m.",
          row.outliers, row.runs, mean_sd(row.searched_s), mean_sd(row.last_distance_m)));
  }
  table.notes.push_back(
      "Reaction times are by name; the paper's U1 and U2 of others are exchanged "
      "(docs/study-suave.md).");
  table.notes.push_back(fmt::format("{} runs each, seed {}, generation {}.", campaign.runs,
                                    campaign.seed, campaign.generation->name));
  return table;
}

Table honest_table(const SuaveCampaign& campaign, const std::vector<SuaveRow>& rows) {
  Table table{"suave-honest",
              fmt::format("SUAVE, {} mission: all runs, nothing left out", campaign.plan->name),
              {{"", "manager", "", "", Align::kLeft},
               {"", "success"},
               {"", "found"},
               {"", "search [s]"},
               {"", "inspected in all [m]"},
               {"not reacted to", "visibility"},
               {"not reacted to", "thruster"},
               {"not reacted to", "battery"}},
              {},
              {}};
  for (const SuaveRow& row : rows) {
    table.rows.push_back({{row.manager},
                          {fmt::format("{} of {}", row.successes, row.runs)},
                          {fmt::format("{} of {}", row.found, row.runs)},
                          {mean_sd(row.searched_s)},
                          {mean_sd(row.whole_distance_m)},
                          {fmt::format("{}", row.visibility.unanswered)},
                          {fmt::format("{}", row.thruster.unanswered)},
                          {fmt::format("{}", row.battery.unanswered)}});
  }
  table.notes.push_back(
      "Success: the pipeline was found and inspected for 10 m at least, and, where the battery "
      "counts, it never ran empty. A pipeline that was not found counts as searched to the end.");
  return table;
}

Table tests_table(const std::vector<Test>& tests) {
  Table table{"suave-tests",
              "culprit against the others: Welch's t-test over all runs",
              {{"", "against", "", "", Align::kLeft},
               {"", "metric", "", "", Align::kLeft},
               {"", "difference"},
               {"", "95 % interval"},
               {"", "t"},
               {"", "df"},
               {"", "p"}},
              {},
              {}};
  for (const Test& test : tests) {
    const WelchTest& r = test.result;
    table.rows.push_back({{test.baseline},
                          {test.title},
                          {number(r.difference)},
                          {fmt::format("{} to {}", number(r.low), number(r.high))},
                          {number(r.t)},
                          {number(r.degrees, 1)},
                          {p_value(r.p)}});
  }
  return table;
}

// ---- JSON

Json json(const Moments& moments) {
  if (moments.count() == 0) return {{"mean", nullptr}, {"sd", nullptr}};
  return {{"mean", moments.mean()}, {"sd", moments.sample_sd()}};
}

Json json(const SuaveReactions& reactions) {
  Json json = study::json(reactions.answered_s);
  json["count"] = reactions.answered_s.count();
  return json;
}

Json json(const std::optional<double>& seconds) { return seconds ? Json(*seconds) : Json(nullptr); }

Json json(const published::SuaveResult* paper) {
  if (paper == nullptr) return nullptr;
  return {{"search_time_s", json(paper->search_s)},
          {"distance_m", json(paper->distance_m)},
          {"reaction_s",
           {{"visibility", json(paper->visibility_s)},
            {"thruster", json(paper->thruster_s)},
            {"battery", json(paper->battery_s)}}}};
}

Json json(const SuaveRow& row, const SuaveCampaign& campaign) {
  return {{"manager", row.manager},
          {"mission", campaign.plan->name},
          {"runs", row.runs},
          {"outliers", row.outliers},
          {"search_time_s", json(row.search_s)},
          {"distance_m", json(row.distance_m)},
          {"reaction_s",
           {{"visibility", json(row.visibility)},
            {"thruster", json(row.thruster)},
            {"battery", json(row.battery)}}},
          {"published", json(published::find_suave(campaign.plan->name, row.manager))},
          {"honest",
           {{"found", row.found},
            {"successes", row.successes},
            {"search_time_s", json(row.searched_s)},
            {"distance_m", json(row.last_distance_m)},
            {"whole_distance_m", json(row.whole_distance_m)},
            {"unanswered",
             {{"visibility", row.visibility.unanswered},
              {"thruster", row.thruster.unanswered},
              {"battery", row.battery.unanswered}}}}}};
}

}  // namespace

std::vector<Table> suave_tables(const SuaveResult& result) {
  std::vector<Table> tables = {results_table(result.campaign, result.rows),
                               honest_table(result.campaign, result.rows)};
  const auto compared = tests(result.rows);
  if (!compared.empty()) tables.push_back(tests_table(compared));
  return tables;
}

std::string suave_json(const SuaveResult& result) {
  Json document = {{"study", SuaveCampaign::kStudy},
                   {"campaign", to_json(result.campaign)},
                   {"rows", Json::array()},
                   {"tests", Json::array()}};
  for (const SuaveRow& row : result.rows) document["rows"].push_back(json(row, result.campaign));
  for (const Test& test : tests(result.rows)) {
    document["tests"].push_back({{"first", test.baseline},
                                 {"second", kCulprit},
                                 {"metric", test.metric},
                                 {"t", test.result.t},
                                 {"degrees", test.result.degrees},
                                 {"p", test.result.p},
                                 {"difference", test.result.difference}});
  }
  return to_indented(document) + "\n";
}

}  // namespace culprit::study
