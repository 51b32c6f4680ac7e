#include "rca_study/rca_report.h"

#include <fmt/core.h>

#include "json/json.h"
#include "rca_study/campaign_json.h"
#include "study/pareto.h"
#include "study/statistics/holm.h"
#include "study/statistics/welch.h"
#include "study/tables/columns.h"

namespace culprit::study::rca {
namespace {

std::optional<double> path(const RcaRow& row) {
  if (row.effects == 0) return std::nullopt;
  return static_cast<double>(row.grounded) / static_cast<double>(row.effects);
}

std::optional<double> plan_us(const RcaRow& row, Times times) {
  if (times == Times::kLeftOut || row.plans == 0) return std::nullopt;
  return row.planning_us / static_cast<double>(row.plans);
}

// By row, whether no other planner beats it in the same setting. Empty for the optimum: it is a
// bound.
std::vector<std::optional<bool>> on_front(const std::vector<RcaRow>& rows) {
  std::vector<std::optional<bool>> is_on(rows.size());
  for (const RcaRow& first : rows) {
    std::vector<std::size_t> members;
    std::vector<std::vector<double>> costs;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const RcaRow& row = rows[i];
      if (row.planner == "optimum" || !(row.setting == first.setting)) continue;
      members.push_back(i);
      costs.push_back({-row.exact.mean(), row.strategies_per_fault.mean(),
                       row.wrong_component.mean(), row.unnecessary.mean(), row.downtime_s.mean(),
                       row.recovery_s.mean(), row.unresolved.mean()});
    }
    const std::vector<bool> front = pareto_front(costs);
    for (std::size_t m = 0; m < members.size(); ++m) is_on[members[m]] = front[m];
  }
  return is_on;
}

// All figures of a row, in the order of the output.
Json figures(const RcaRow& row, std::optional<bool> is_on_front, Times times) {
  const auto optional = [](std::optional<double> value) { return value ? Json(*value) : Json(); };
  Json json{{"planner", row.planner},
            {"components", row.setting.components},
            {"faults", row.setting.faults},
            {"noise", row.setting.noise},
            {"cyclic", row.setting.is_cyclic},
            {"episodes", row.episodes},
            {"exact_set", row.exact.mean()},
            {"top1", row.first_right.mean()},
            {"path", optional(path(row))},
            {"wrong_component", row.wrong_component.mean()},
            {"unnecessary", row.unnecessary.mean()},
            {"strategies_per_fault", row.strategies_per_fault.mean()},
            {"downtime_s", row.downtime_s.mean()},
            {"recovery_s", row.recovery_s.mean()},
            {"unresolved", row.unresolved.mean()},
            {"regret", optional(row.regret)},
            {"plan_us", optional(plan_us(row, times))},
            {"on_front", is_on_front ? Json(*is_on_front) : Json()}};
  const std::string factors = options_of(row.setting.factors);
  if (!factors.empty()) json["factors"] = factors.substr(1);
  return json;
}

std::string percent(std::optional<double> share) { return share ? number(100 * *share, 1) : "–"; }

// bayes against each other planner of the same setting; p by Holm over all of the table.
void add_tests(const std::vector<RcaRow>& rows, Table& table) {
  struct Test {
    const RcaRow* ours;
    const RcaRow* other;
    WelchTest wrong;
    WelchTest recovery;
  };
  std::vector<Test> tests;
  std::vector<double> p;
  for (const RcaRow& ours : rows) {
    if (ours.planner != "bayes") continue;
    for (const RcaRow& other : rows) {
      if (other.planner == "bayes" || !(other.setting == ours.setting)) continue;
      const auto wrong = welch_test(other.wrong_component, ours.wrong_component);
      const auto recovery = welch_test(other.recovery_s, ours.recovery_s);
      if (!wrong || !recovery) continue;
      tests.push_back({&ours, &other, *wrong, *recovery});
      p.insert(p.end(), {wrong->p, recovery->p});
    }
  }
  p = holm(p);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const RcaSetting& setting = tests[i].ours->setting;
    table.notes.push_back(fmt::format(
        "{} components, {} faults, noise {:g}{}: bayes beside {}: wrong components {:+.2f} "
        "(p {}), recovery {:+.1f} s (p {}); Welch, Holm over the table.",
        setting.components, setting.faults, setting.noise, setting.is_cyclic ? ", cyclic" : "",
        tests[i].other->planner, tests[i].wrong.difference, p_value(p[2 * i]),
        tests[i].recovery.difference, p_value(p[2 * i + 1])));
  }
}

}  // namespace

Table rca_table(const RcaCampaign& campaign, const std::vector<RcaRow>& rows, Times times) {
  // All settings of a campaign have the same of these.
  const RcaSetting& all = campaign.settings.front();
  std::string robots;
  if (all.has_mixed_levels) robots += ", mixed levels";
  if (all.is_flapping) robots += ", flapping faults";
  if (all.has_unfixable) robots += ", one fault that nothing fixes";
  if (all.ignores_plumbing) robots += ", infrastructure ignored";
  if (const std::string factors = describe(all.factors); !factors.empty()) robots += ", " + factors;
  Table table{"rca",
              fmt::format("Root causes on random robots{}: means of {} episodes, seed {}", robots,
                          campaign.episodes, campaign.seed),
              {{"", "planner", "", "", Align::kLeft},
               {"", "components"},
               {"", "faults"},
               {"", "noise"},
               {"", "cyclic", "", "", Align::kCentre},
               {"right [%]", "exact set"},
               {"right [%]", "top 1"},
               {"right [%]", "path"},
               {"adaptations", "per fault"},
               {"adaptations", "wrong component"},
               {"adaptations", "unnecessary"},
               {"", "downtime [s]"},
               {"", "recovery [s]"},
               {"", "unresolved"},
               {"", "regret [%]"},
               {"", "on the front", "", "", Align::kCentre}},
              {},
              {}};
  if (times == Times::kShown) table.columns.push_back({"", "plan [us]"});
  const auto front = on_front(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RcaRow& row = rows[i];
    std::vector<Cell> cells = {{row.planner},
                               {std::to_string(row.setting.components)},
                               {std::to_string(row.setting.faults)},
                               {number(row.setting.noise)},
                               {row.setting.is_cyclic ? "✓" : "–"},
                               {percent(row.exact.mean())},
                               {percent(row.first_right.mean())},
                               {percent(path(row))},
                               {number(row.strategies_per_fault.mean())},
                               {number(row.wrong_component.mean())},
                               {number(row.unnecessary.mean())},
                               {number(row.downtime_s.mean())},
                               {number(row.recovery_s.mean())},
                               {number(row.unresolved.mean())},
                               {percent(row.regret)},
                               {!front[i]   ? ""
                                : *front[i] ? "✓"
                                            : "–"}};
    if (times == Times::kShown) {
      const auto us = plan_us(row, times);
      cells.push_back({us ? number(*us, 1) : "–"});
    }
    if (row.censored > 0)
      table.notes.push_back(
          fmt::format("{} of {} robots of {} did not recover; their time counts until the end.",
                      row.censored, row.episodes, row.planner));
    table.rows.push_back(std::move(cells));
  }
  table.notes.push_back(
      "On the (Pareto) front: no other planner is as good in the exact set, adaptations, downtime, "
      "recovery and what is unresolved, and better in one of them.");
  add_tests(rows, table);
  return table;
}

std::string rca_csv(const std::vector<RcaRow>& rows, Times times) {
  std::string out;
  const auto front = on_front(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json all = figures(rows[i], front[i], times);
    std::string head;
    std::string line;
    for (const auto& [key, value] : all.items()) {
      const char* comma = head.empty() ? "" : ",";
      head += comma + key;
      line += comma;
      if (!value.is_null()) line += value.is_string() ? value.get<std::string>() : to_line(value);
    }
    if (out.empty()) out = head + "\n";
    out += line + "\n";
  }
  return out;
}

std::string rca_json(const RcaCampaign& campaign, const std::vector<RcaRow>& rows, Times times) {
  Json document = {
      {"study", RcaCampaign::kStudy}, {"campaign", to_json(campaign)}, {"rows", Json::array()}};
  const auto front = on_front(rows);
  for (std::size_t i = 0; i < rows.size(); ++i)
    document["rows"].push_back(figures(rows[i], front[i], times));
  return to_indented(document) + "\n";
}

}  // namespace culprit::study::rca
