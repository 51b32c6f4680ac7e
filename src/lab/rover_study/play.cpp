#include "rover_study/play.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "demo/episode.h"
#include "exemplars/rover/model/rover_model.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "rover_study/rover_managers.h"
#include "simulation/random.h"

namespace culprit::study {
namespace {

using namespace std::chrono_literals;
using rover::model::RoverModel;

constexpr Duration kLooks = 100ms;
constexpr Duration kCalm = 2s;

std::unique_ptr<ManagingSystem> manager_of(const std::string& name, const RuleSet& rules,
                                           const rover::Play& play, Time at) {
  const Manager::Options options{.discovery = Duration::zero()};
  if (name == "bayes")
    return std::make_unique<Manager>(rules, std::make_unique<BayesPlanner>(), options);
  if (name == "paper")
    return std::make_unique<Manager>(rules, std::make_unique<PaperPlanner>(), options);
  if (name == "oracle") return std::make_unique<RoverOracle>(rules, play.faults, at);
  if (name == "respawn") return std::make_unique<ProcessKeeper>(rules, ProcessKeeper::respawn());
  if (name == "watchdog") return std::make_unique<ProcessKeeper>(rules, ProcessKeeper::watchdog());
  return std::make_unique<RoverOracle>(rules, std::vector<const rover::Fault*>{}, at);
}

}  // namespace

const std::vector<std::string>& rover_managers() {
  static const std::vector<std::string> kAll = {"none",  "nav2",  "respawn", "watchdog",
                                                "paper", "bayes", "oracle"};
  return kAll;
}

int right_of(const rover::Play& play, const std::vector<std::string>& names) {
  return static_cast<int>(std::ranges::count_if(play.faults, [&](const rover::Fault* fault) {
    return std::ranges::find(names, fault->cause) != names.end();
  }));
}

RoverResult play(const RuleSet& rules, const rover::Play& play, const std::string& manager,
                 Duration watched, const std::function<void(const Event&)>& on_event) {
  simulation::Random random(play.seed);
  const bool is_culprit = manager == "bayes" || manager == "paper" || manager == "oracle";
  RoverModel model(rules,
                   {.seed = play.seed, .has_bonds = manager != "none", .withdraws = is_culprit});
  const Time at = Time{RoverTimes::kWarmUp + from_seconds(random.uniform(0, 5))};
  const auto system = manager_of(manager, rules, play, at);
  std::optional<lab::Episode> episode;
  RoverResult result;
  Runtime runtime(*system, model);
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      if (episode) episode->add(event);
      if (on_event) on_event(event);
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, at);
  model.on_healthy_taken_down = [&](ComponentId id) {
    if (!play.is_cause(rules[id].name)) ++result.wrong_restarts;
  };
  const auto before = model.measure();
  episode.emplace(rules);
  for (const rover::Fault* fault : play.faults) model.inject(*fault);

  std::optional<Time> well;
  const Time end = later(at, watched);
  for (Time look = at; look < end;) {
    look = std::min(later(look, kLooks), end);
    runtime.run(never, look);
    if (result.healed_s) continue;
    const bool is_over = std::ranges::all_of(
        play.faults, [&](const rover::Fault* fault) { return model.is_over(*fault); });
    const bool is_well = is_over && model.measure().complaint.empty() && episode->open() == 0;
    if (!is_well) well.reset();
    if (is_well && !well) well = look;
    if (well && *well < later(at, RoverTimes::kPatience) && look >= later(*well, kCalm))
      result.healed_s = seconds(*well - at);
  }

  const auto after = model.measure();
  if (after.standing_s > 2)
    result.stands_after_s = std::max(0.0, seconds(watched) - after.standing_s);
  result.watched_s = seconds(watched);
  result.stood_s = after.stood_s - before.stood_s;
  result.goals = after.goals_reached - before.goals_reached;
  result.complaint = after.complaint;
  result.calls = episode->calls();
  result.is_noticed = !episode->failures().empty();
  result.names = episode->blamed();
  result.strategies = episode->strategies();
  result.blamed = right_of(play, result.names);
  return result;
}

}  // namespace culprit::study
