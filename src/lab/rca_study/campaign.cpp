#include "rca_study/campaign.h"

#include <algorithm>
#include <span>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "knowledge/condensation.h"
#include "managers/style_planner.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "rca_study/baselines.h"
#include "rca_study/optimum.h"
#include "rca_study/rules.h"
#include "rca_study/timing_planners.h"
#include "simulation/random.h"
#include "study/ordered_work.h"

namespace culprit::study::rca {
namespace {

constexpr std::string_view kPatient = "patient:";

// How long "patient" or "patient:2s" waits; nothing if the latter says no duration.
std::optional<Duration> wait_of(std::string_view name) {
  if (!name.starts_with(kPatient)) return PatientPlanner::kUsual;
  const auto wait = parse_duration(name.substr(kPatient.size()));
  return wait ? std::optional(*wait) : std::nullopt;
}

// Expected costs in the decision process of one robot: of the optimum, and of each planner.
struct Costs {
  double optimum = 0;
  std::vector<double> of;
};

Costs costs_of(const RcaCampaign& campaign, const RcaScenario& scenario) {
  const RuleSet rules = rules_of(scenario);
  const RepairProcess process(scenario, rules, campaign.objective);
  Costs costs;
  costs.optimum = Optimum(process).cost();
  for (const std::string& name : campaign.planners) {
    const auto planner = make_planner(name, campaign.objective, scenario);
    costs.of.push_back(name == "optimum" ? costs.optimum
                                         : expected_cost(process, rules, **planner));
  }
  return costs;
}

// From other faults of the same robot, as many at a time as in the episode.
Experience experience_of(const RcaCampaign& campaign, const RcaSetting& setting,
                         const std::string& planner, const RcaScenario& scenario,
                         const RuleSet& rules) {
  Experience experience;
  RcaScenario earlier = scenario;
  for (std::size_t faults = 0; faults < setting.factors.faults_before;
       faults += std::max<std::size_t>(1, earlier.faults.size())) {
    earlier.seed = simulation::mix(earlier.seed);
    earlier.faults = random_faults(setting, earlier.seed);
    play(earlier, rules, std::move(*make_planner(planner, campaign.objective, earlier)),
         experience);
  }
  return experience;
}

// Row by row, with the same robot: its rules are written and checked once.
std::vector<EpisodeResult> play_all(const RcaCampaign& campaign, std::span<const RcaRow> rows,
                                    std::uint32_t episode) {
  const RcaScenario scenario = scenario_of(campaign, rows.front().setting, episode);
  const RuleSet rules = rules_of(scenario);
  std::vector<EpisodeResult> results;
  for (const RcaRow& row : rows) {
    auto planner = make_planner(row.planner, campaign.objective, scenario);
    Experience experience = experience_of(campaign, row.setting, row.planner, scenario, rules);
    results.push_back(play(scenario, rules, std::move(*planner), experience));
  }
  return results;
}

// Counts what is done of all that a campaign is.
class Count {
 public:
  Count(std::uint64_t total, const GoOn& go_on) : total_(total), go_on_(go_on) {}

  bool next() {
    ++done_;
    return !go_on_ || go_on_(done_, total_);
  }

 private:
  std::uint64_t done_ = 0;
  const std::uint64_t total_;
  const GoOn& go_on_;
};

// A scenario from a file has one robot, whatever the episode's luck is.
std::uint64_t robots_of(const RcaCampaign& campaign) {
  return campaign.scenario ? 1 : campaign.episodes;
}

// Computes the regrets of one setting's rows. For a robot that is too large there is none.
bool find_regrets(const RcaCampaign& campaign, unsigned jobs, Count& count,
                  std::span<RcaRow> rows) {
  const RcaSetting& setting = rows.front().setting;
  const std::uint64_t robots = robots_of(campaign);
  // It is unknown for robots with faulty detectors, and for faults that are restricted in kind.
  const bool is_known = setting.noise <= 0 && !setting.is_flapping && !setting.has_unfixable &&
                        setting.components <= RepairProcess::kMostComponents;
  Costs sum{0, std::vector<double>(rows.size(), 0)};
  std::uint64_t done = 0;
  work_in_order(
      0, robots, jobs,
      [&](std::uint64_t i) -> std::optional<Costs> {
        if (!is_known) return std::nullopt;
        const auto scenario = scenario_of(campaign, setting, static_cast<std::uint32_t>(i));
        if (!RepairProcess::is_small(scenario)) return std::nullopt;
        return costs_of(campaign, scenario);
      },
      [&](std::uint64_t, const std::optional<Costs>& costs) {
        if (!count.next()) return false;
        ++done;
        if (!costs) return true;
        sum.optimum += costs->optimum;
        for (std::size_t p = 0; p < rows.size(); ++p) sum.of[p] += costs->of[p];
        return true;
      });
  for (std::size_t p = 0; p < rows.size() && sum.optimum > 0; ++p)
    rows[p].regret = sum.of[p] / sum.optimum - 1;
  return done == robots;
}

}  // namespace

std::vector<std::string> planner_names() {
  return {"naive", "first-failing", "topological", "random-walk", "paper",
          "bayes", "patient",       "informed",    "rebet",       "ac-ros",
          "vogel", "ghahremani",    "optimum"};
}

std::vector<std::string> usual_planners() {
  auto names = planner_names();
  std::erase_if(names, [](const std::string& name) {
    return name == "patient" || name == "informed" || find_style(name).has_value();
  });
  return names;
}

std::optional<std::string> complaint_about_planner(const std::string& name) {
  const auto names = planner_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return std::nullopt;
  if (name.starts_with(kPatient)) {
    const auto wait = wait_of(name);
    if (wait && *wait >= PatientPlanner::kLeast && *wait <= PatientPlanner::kMost)
      return std::nullopt;
    return fmt::format("the wait of planner '{}' is not from {} to {}; write it as in patient:2s",
                       name, culprit::to_string(PatientPlanner::kLeast),
                       culprit::to_string(PatientPlanner::kMost));
  }
  return fmt::format("there is no planner '{}'; there are {}", name, fmt::join(names, ", "));
}

Expected<std::unique_ptr<const Planner>> make_planner(const std::string& name, Objective objective,
                                                      const RcaScenario& scenario) {
  using Made = std::unique_ptr<const Planner>;
  if (const auto complaint = complaint_about_planner(name)) return Error{*complaint};
  if (name == "bayes") return Made(std::make_unique<BayesPlanner>(objective));
  if (name == "paper") return Made(std::make_unique<PaperPlanner>());
  if (name == "naive")
    return Made(std::make_unique<PaperPlanner>(PaperSwitches{false, true, true}));
  if (name == "first-failing")
    return Made(std::make_unique<RankingPlanner>(Ranking::kFirstFailing));
  if (name == "topological") return Made(std::make_unique<RankingPlanner>(Ranking::kTopological));
  if (name == "random-walk") return Made(std::make_unique<RankingPlanner>(Ranking::kRandomWalk));
  if (name == "informed") return Made(std::make_unique<InformedPlanner>(scenario));
  if (name.starts_with("patient")) return Made(std::make_unique<PatientPlanner>(*wait_of(name)));
  if (const auto style = find_style(name)) return Made(std::make_unique<StylePlanner>(*style));
  if (RepairProcess::is_small(scenario)) return Made(optimum_planner(scenario, objective));
  return Error{
      "the optimum is only known of small robots: at most " +
      std::to_string(RepairProcess::kMostComponents) + " components, " +
      std::to_string(RepairProcess::kMostSubscriptions) + " subscriptions and " +
      std::to_string(RepairProcess::kMostFaults) +
      " faults; each component has a rule, and nothing is a common cause or a false alarm"};
}

void RcaRow::add(const EpisodeResult& result) {
  ++episodes;
  exact.add(result.is_exact ? 1 : 0);
  first_right.add(result.is_first_right ? 1 : 0);
  effects += result.effects;
  grounded += result.grounded;
  wrong_component.add(result.wrong_component);
  unnecessary.add(result.unnecessary);
  if (result.faults > 0)
    strategies_per_fault.add(static_cast<double>(result.strategies) / result.faults);
  downtime_s.add(result.downtime_s);
  recovery_s.add(result.recovery_s);
  censored += result.is_recovered ? 0 : 1;
  unresolved.add(result.unresolved);
  plans += result.plans;
  planning_us += result.planning_us;
}

RcaScenario scenario_of(const RcaCampaign& campaign, const RcaSetting& setting,
                        std::uint32_t episode) {
  if (!campaign.scenario)
    return generate(setting, simulation::mix(simulation::mix(campaign.seed) + episode));
  RcaScenario scenario = *campaign.scenario;
  if (episode > 0) scenario.seed = simulation::mix(scenario.seed + episode);
  return scenario;
}

Expected<SingleRun> single_run(const RcaCampaign& campaign, RunId id) {
  const RcaSetting& setting = campaign.settings[id.row / campaign.planners.size()];
  const std::string& planner = campaign.planners[id.row % campaign.planners.size()];
  const RcaScenario scenario = scenario_of(campaign, setting, id.run);
  auto made = make_planner(planner, campaign.objective, scenario);
  if (!made) return Error{made.error()};
  return single_run(scenario, std::move(*made),
                    experience_of(campaign, setting, planner, scenario, rules_of(scenario)));
}

bool has_optimum(const RcaCampaign& campaign) {
  if (campaign.scenario) return RepairProcess::is_small(*campaign.scenario);
  return std::all_of(campaign.settings.begin(), campaign.settings.end(), [](const RcaSetting& s) {
    return s.components <= RepairProcess::kMostComponents &&
           s.faults <= RepairProcess::kMostFaults && s.factors.unwatched <= 0 &&
           s.factors.common_causes == 0 && s.factors.false_alarms <= 0;
  });
}

RcaSetting setting_of(const RcaScenario& scenario) {
  RcaSetting setting{scenario.components.size(), scenario.faults.size(), 0, false};
  for (const RcaComponent& c : scenario.components)
    setting.noise = std::max({setting.noise, c.detector.miss, c.detector.false_alarm});
  ChannelEdges edges(scenario.components.size());
  for (const RcaTopic& topic : scenario.topics) {
    const std::vector<std::uint32_t> publishers(topic.publishers.begin(), topic.publishers.end());
    std::vector<std::uint32_t> subscribers;
    for (const Subscription& s : topic.subscribers) {
      if (s.passes > 0) subscribers.push_back(static_cast<std::uint32_t>(s.component));
    }
    if (!publishers.empty() && !subscribers.empty()) edges.add(publishers, subscribers);
  }
  setting.is_cyclic = Condensation(edges.vertices(), edges.edges()).size() < edges.vertices();
  return setting;
}

std::optional<std::vector<RcaRow>> run_campaign(const RcaCampaign& campaign, unsigned jobs,
                                                const GoOn& go_on) {
  std::vector<RcaRow> rows;
  for (const RcaSetting& setting : campaign.settings) {
    for (const std::string& planner : campaign.planners) {
      RcaRow& row = rows.emplace_back();
      row.planner = planner;
      row.setting = setting;
    }
  }
  if (rows.empty()) return rows;
  // The planners share an episode's robot, unless there are too few episodes for all threads.
  const std::size_t planners = campaign.planners.size();
  const std::size_t together = campaign.episodes < jobs ? 1 : planners;
  const std::uint64_t pieces = planners / together;  // of an episode
  const auto rows_of = [&](std::uint64_t i) {
    const std::uint64_t setting = i / pieces / campaign.episodes;
    return std::span(rows).subspan(setting * planners + i % pieces * together, together);
  };
  const std::uint64_t size = std::uint64_t{campaign.episodes} * rows.size();
  Count count(size + robots_of(campaign) * campaign.settings.size(), go_on);
  std::uint64_t played = 0;
  work_in_order(
      0, size / together, jobs,
      [&](std::uint64_t i) {
        return play_all(campaign, rows_of(i),
                        static_cast<std::uint32_t>(i / pieces % campaign.episodes));
      },
      [&](std::uint64_t i, const std::vector<EpisodeResult>& results) {
        const std::span<RcaRow> its_rows = rows_of(i);
        for (std::size_t p = 0; p < results.size(); ++p) {
          its_rows[p].add(results[p]);
          ++played;
          if (!count.next()) return false;
        }
        return true;
      });
  if (played < size) return std::nullopt;
  for (std::size_t first = 0; first < rows.size(); first += planners) {
    if (!find_regrets(campaign, jobs, count, std::span(rows).subspan(first, planners)))
      return std::nullopt;
  }
  return rows;
}

}  // namespace culprit::study::rca
