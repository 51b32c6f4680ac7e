#include "suave_study/validation.h"

#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/invariant.h"
#include "json/json.h"
#include "study/statistics/rank_correlation.h"
#include "study/tables/columns.h"
#include "suave_study/suave_record.h"

namespace culprit::study {
namespace {

struct Compared {
  const char* metric;
  const char* title;
  Moments SuaveRow::*modelled;
  Moments RecordedRow::*recorded;
};

constexpr Compared kCompared[] = {
    {"search_time_s", "search [s]", &SuaveRow::search_s, &RecordedRow::search_s},
    {"distance_m", "inspected [m]", &SuaveRow::distance_m, &RecordedRow::distance_m},
};

ValidationRow compared(const Compared& what, const RecordedRow& recorded, const SuaveRow& modelled,
                       double margin_sd) {
  ValidationRow row{recorded.manager,        what.metric, what.title, recorded.*what.recorded,
                    modelled.*what.modelled, false,       {}};
  const double sd = row.recorded.sample_sd();
  row.is_within = std::abs(row.modelled.mean() - row.recorded.mean()) <= sd;
  if (sd > 0) row.test = equivalence_test(row.recorded, row.modelled, margin_sd * sd);
  return row;
}

RankAgreement agreement(const Compared& what, const std::vector<ValidationRow>& rows) {
  std::vector<double> recorded;
  std::vector<double> modelled;
  for (const ValidationRow& row : rows) {
    if (row.metric != what.metric) continue;
    recorded.push_back(row.recorded.mean());
    modelled.push_back(row.modelled.mean());
  }
  return {what.metric, what.title, recorded.size(), spearman_rho(recorded, modelled),
          kendall_tau(recorded, modelled)};
}

std::string mean_sd(const Moments& moments) {
  return fmt::format("{} ± {} ({})", number(moments.mean()), number(moments.sample_sd()),
                     moments.count());
}

std::string number_if(const std::optional<double>& value) { return value ? number(*value) : "–"; }

Table rows_table(const Validation& validation) {
  Table table{"suave-validation",
              fmt::format("SUAVE, {} mission: the model beside recorded runs",
                          validation.campaign.plan->name),
              {{"", "manager", "", "", Align::kLeft},
               {"", "metric", "", "", Align::kLeft},
               {"", "recorded"},
               {"", "modelled"},
               {"", "within 1 sd"},
               {"", "difference, 90 % interval"},
               {"", "margin"},
               {"", "p"},
               {"", "equivalent"}},
              {},
              {}};
  for (const ValidationRow& row : validation.rows) {
    const auto& test = row.test;
    table.rows.push_back({{row.manager},
                          {row.title},
                          {mean_sd(row.recorded)},
                          {mean_sd(row.modelled)},
                          {row.is_within ? "✓" : "✗"},
                          {test ? fmt::format("{}: {} to {}", number(test->difference),
                                              number(test->low), number(test->high))
                                : "–"},
                          {test ? number(test->margin) : "–"},
                          {test ? p_value(test->p) : "–"},
                          {!test                   ? "–"
                           : test->is_equivalent() ? "✓"
                                                   : "✗"}});
  }
  table.notes.push_back(
      fmt::format("Mean ± sd (runs). Equivalent: two one-sided tests rule out, at 5 %, that the "
                  "means differ by "
                  "{} of the recorded sd or more.",
                  number(validation.margin_sd)));
  if (!validation.left_out.empty())
    table.notes.push_back(
        fmt::format("Recorded, but not in this study: {}.", fmt::join(validation.left_out, ", ")));
  return table;
}

Table ranks_table(const Validation& validation) {
  Table table{"suave-ranks",
              "Are the managers in the same order?",
              {{"", "metric", "", "", Align::kLeft},
               {"", "managers"},
               {"", "Spearman's rho"},
               {"", "Kendall's tau"}},
              {},
              {}};
  for (const RankAgreement& each : validation.ranks)
    table.rows.push_back({{each.title},
                          {fmt::format("{}", each.managers)},
                          {number_if(each.spearman_rho)},
                          {number_if(each.kendall_tau)}});
  return table;
}

Json json(const Moments& moments) {
  return {{"count", moments.count()}, {"mean", moments.mean()}, {"sd", moments.sample_sd()}};
}

Json json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json(const ValidationRow& row) {
  Json json = {{"manager", row.manager},
               {"metric", row.metric},
               {"recorded", study::json(row.recorded)},
               {"modelled", study::json(row.modelled)},
               {"within_1_sd", row.is_within}};
  const auto put = [&](const char* name, auto value) {
    json[name] = row.test ? Json(value(*row.test)) : Json(nullptr);
  };
  put("difference", [](const EquivalenceTest& test) { return test.difference; });
  put("low", [](const EquivalenceTest& test) { return test.low; });
  put("high", [](const EquivalenceTest& test) { return test.high; });
  put("margin", [](const EquivalenceTest& test) { return test.margin; });
  put("p", [](const EquivalenceTest& test) { return test.p; });
  put("equivalent", [](const EquivalenceTest& test) { return test.is_equivalent(); });
  return json;
}

}  // namespace

Validation validate(SuaveCampaign campaign, const RecordedCampaign& recorded, double margin_sd,
                    unsigned jobs) {
  CULPRIT_ASSERT(margin_sd > 0);
  campaign.managers.clear();
  for (const RecordedRow& row : recorded.rows) campaign.managers.push_back(row.manager);
  const SuaveResult result = run_campaign(campaign, jobs);
  Validation validation{std::move(campaign), margin_sd, recorded.unknown, {}, {}};
  for (const Compared& what : kCompared) {
    for (std::size_t i = 0; i < result.rows.size(); ++i)
      validation.rows.push_back(compared(what, recorded.rows[i], result.rows[i], margin_sd));
    validation.ranks.push_back(agreement(what, validation.rows));
  }
  return validation;
}

std::vector<Table> validation_tables(const Validation& validation) {
  return {rows_table(validation), ranks_table(validation)};
}

std::string validation_json(const Validation& validation) {
  Json document = {{"study", "suave-validation"},
                   {"campaign", to_json(validation.campaign)},
                   {"margin_sd", validation.margin_sd},
                   {"left_out", validation.left_out},
                   {"rows", Json::array()},
                   {"ranks", Json::array()}};
  for (const ValidationRow& row : validation.rows) document["rows"].push_back(json(row));
  for (const RankAgreement& each : validation.ranks) {
    document["ranks"].push_back({{"metric", each.metric},
                                 {"managers", each.managers},
                                 {"spearman_rho", json(each.spearman_rho)},
                                 {"kendall_tau", json(each.kendall_tau)}});
  }
  return to_indented(document) + "\n";
}

}  // namespace culprit::study
