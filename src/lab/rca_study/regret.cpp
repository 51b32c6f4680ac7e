#include "rca_study/regret.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "json/json.h"
#include "plan/bayes/bayes_planner.h"
#include "rca_study/optimum.h"
#include "rca_study/rules.h"
#include "simulation/random.h"
#include "study/ordered_work.h"
#include "study/tables/columns.h"

namespace culprit::study::rca {
namespace {

constexpr std::array kEveryObjective = {Objective::kBalanced, Objective::kDowntime,
                                        Objective::kAdaptations, Objective::kRedeployments};
constexpr std::size_t kLargest = 4;

std::uint64_t seed_of(std::uint64_t seed, std::uint32_t system) {
  return simulation::mix(simulation::mix(seed) + system);
}

}  // namespace

double Regrets::mean() const {
  return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
}

double Regrets::percentile_95() const {
  std::vector<double> sorted = of;
  std::sort(sorted.begin(), sorted.end());
  const double place = std::ceil(0.95 * static_cast<double>(of.size()));
  return sorted[static_cast<std::size_t>(place) - 1];
}

std::size_t Regrets::worst() const {
  return static_cast<std::size_t>(std::max_element(of.begin(), of.end()) - of.begin());
}

RcaSetting regret_setting(const RegretCampaign& campaign, std::uint32_t system) {
  simulation::Random random(simulation::mix(seed_of(campaign.seed, system)));
  RcaSetting setting;
  setting.components = 1 + random.next() % kLargest;
  setting.faults = 1 + random.next() % std::min(setting.components, RepairProcess::kMostFaults);
  setting.is_cyclic = random.chance(0.5);
  setting.has_mixed_levels = random.chance(0.5);
  setting.is_as_told = campaign.is_as_told;
  return setting;
}

RcaScenario regret_scenario(const RegretCampaign& campaign, std::uint32_t system) {
  return generate(regret_setting(campaign, system), seed_of(campaign.seed, system));
}

std::optional<std::vector<Regrets>> measure_regret(const RegretCampaign& campaign, unsigned jobs,
                                                   const GoOn& go_on,
                                                   const std::function<bool()>& is_stopped) {
  using OfSystem = std::array<double, kEveryObjective.size()>;
  std::vector<Regrets> all;
  for (const Objective objective : kEveryObjective) all.push_back({objective, {}});
  work_in_order(
      0, campaign.systems, jobs,
      [&](std::uint64_t i) -> std::optional<OfSystem> {
        const RcaScenario scenario = regret_scenario(campaign, static_cast<std::uint32_t>(i));
        const RuleSet rules = rules_of(scenario);
        OfSystem regrets{};
        for (std::size_t o = 0; o < regrets.size(); ++o) {
          if (is_stopped && is_stopped()) return std::nullopt;
          const RepairProcess process(scenario, rules, kEveryObjective[o]);
          const double ours = expected_cost(process, rules, BayesPlanner(kEveryObjective[o]));
          regrets[o] = ours / Optimum(process).cost() - 1;
        }
        return regrets;
      },
      [&](std::uint64_t i, const std::optional<OfSystem>& regrets) {
        if (!regrets) return false;
        for (std::size_t o = 0; o < regrets->size(); ++o) all[o].of.push_back((*regrets)[o]);
        return !go_on || go_on(i + 1, campaign.systems);
      });
  if (all.front().of.size() < campaign.systems) return std::nullopt;
  return all;
}

Table regret_table(const RegretCampaign& campaign, const std::vector<Regrets>& regrets) {
  Table table{
      "regret",
      fmt::format("Regret of bayes on {} random robots of up to {} components that {}, seed {}",
                  campaign.systems, kLargest,
                  campaign.is_as_told ? "are as told" : "differ from what is told", campaign.seed),
      {{"", "objective", "", "", Align::kLeft},
       {"regret [%]", "mean"},
       {"regret [%]", "95th percentile"},
       {"regret [%]", "worst"},
       {"", "worst robot"}},
      {},
      {}};
  for (const Regrets& each : regrets)
    table.rows.push_back({{std::string(to_string(each.objective))},
                          {number(100 * each.mean())},
                          {number(100 * each.percentile_95())},
                          {number(100 * each.of[each.worst()])},
                          {std::to_string(each.worst())}});
  return table;
}

std::string regret_json(const RegretCampaign& campaign, const std::vector<Regrets>& regrets) {
  Json objectives = Json::array();
  for (const Regrets& each : regrets)
    objectives.push_back({{"objective", to_string(each.objective)},
                          {"mean", each.mean()},
                          {"percentile_95", each.percentile_95()},
                          {"worst", each.of[each.worst()]},
                          {"worst_system", each.worst()}});
  const Json document = {{"regret",
                          {{"systems", campaign.systems},
                           {"seed", campaign.seed},
                           {"as_told", campaign.is_as_told},
                           {"objectives", std::move(objectives)}}}};
  return to_indented(document) + "\n";
}

}  // namespace culprit::study::rca
