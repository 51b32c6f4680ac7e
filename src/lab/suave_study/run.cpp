#include "suave_study/run.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "language/checker.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "managers/paced_manager.h"
#include "managers/style_planner.h"
#include "managers/suave_manager.h"
#include "plan/paper_planner.h"
#include "simulation/simulated_robot.h"
#include "suave_study/rules.h"

namespace culprit::study {
namespace {

using suave::model::SuaveModel;

constexpr double kWorthwhileMetres = 10;

// culprit's own delay from a message to its request. Deciding takes microseconds; until the intent
// is in the journal 1 ms was measured (docs/performance.md). The rest is margin.
constexpr Pace kOwn{{}, {std::chrono::milliseconds(1), std::chrono::milliseconds(1)}};

// The rules are the project's own, and a test checks them.
RuleSet checked(const char* name, const char* text) { return *check(Source(name, text)).rules; }

std::unique_ptr<const Planner> planner_of(const std::string& manager) {
  if (const auto style = find_style(manager)) return std::make_unique<StylePlanner>(*style);
  return std::make_unique<PaperPlanner>();
}

const SuaveBaseline* find_baseline(const std::string& name) {
  const auto all = suave_baselines();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const SuaveBaseline& each) { return each.name == name; });
  return found == all.end() ? nullptr : &*found;
}

// Runs until the mission is over. `telling` may be null.
void run_mission(SuaveModel& model, const RuleSet& names, ManagingSystem& manager,
                 SuaveTelling* telling) {
  simulation::SimulatedRobot robot(names, model.world());
  Runtime runtime(manager, robot);
  if (telling != nullptr) {
    runtime.on_events = [telling](std::span<const Event> events) {
      telling->events.insert(telling->events.end(), events.begin(), events.end());
    };
  }
  std::atomic<bool> is_over = false;
  model.mission().on_end = [&] { is_over = true; };
  runtime.run(is_over, model.latest_end());
  model.mission().on_end = nullptr;
}

SuaveRun measure(SuaveModel& model) {
  suave::model::Metrics& metrics = model.metrics();
  metrics.finish();
  SuaveRun run;
  run.is_found = metrics.found().has_value();
  run.found_s = seconds(metrics.found().value_or(*model.mission().ended()) - model.guided());
  run.search_s = std::floor(run.found_s);
  run.distance_m = metrics.distance();
  run.whole_distance_m = metrics.whole_distance();
  run.visibility = metrics.visibility();
  run.thruster = metrics.thruster();
  run.battery = metrics.battery();
  run.is_success = run.is_found && run.whole_distance_m >= kWorthwhileMetres &&
                   !(model.plan().needs_battery && model.battery().ran_empty());
  return run;
}

}  // namespace

const RuleSet& rules_for(const suave::model::MissionPlan& plan) {
  static const RuleSet kStandard = checked("suave.rules", kSuaveRules);
  static const RuleSet kExtended = checked("suave-extended.rules", kSuaveExtendedRules);
  return plan.needs_battery ? kExtended : kStandard;
}

bool has_rules(const std::string& contender) { return find_baseline(contender) == nullptr; }

std::vector<SuaveContender> suave_contenders() {
  std::vector<SuaveContender> contenders;
  for (const SuaveBaseline& each : suave_baselines())
    contenders.push_back({std::string(each.name), std::string(each.summary)});
  contenders.push_back({"ac-ros", "AC-ROS: one plan for each violated goal"});
  contenders.push_back({"vogel", "Vogel: repairs first, then optimises"});
  contenders.push_back({"ghahremani", "Ghahremani: most utility for its cost first"});
  contenders.push_back({kCulprit, "rules, checked after each event"});
  return contenders;
}

SuaveRun play_suave(const std::string& manager, const suave::model::Generation& generation,
                    const suave::model::MissionPlan& plan,
                    const suave::model::VehicleTraits& vehicle, std::uint64_t seed,
                    SuaveTelling* telling) {
  const SuaveBaseline* baseline = find_baseline(manager);
  const auto leader = baseline != nullptr ? baseline->leader : suave::model::Leader::kMission;
  SuaveModel model({generation, plan, leader, vehicle}, seed);
  std::optional<TrackRecorder> recorder;
  if (telling != nullptr) {
    telling->track.manager = manager;
    recorder.emplace(model, telling->track);
  }
  if (baseline != nullptr) {
    const auto system = baseline->make({generation, plan.needs_battery, seed});
    run_mission(model, suave_names(), *system, telling);
  } else {
    Manager::Options options;
    PacedManager system(std::make_unique<Manager>(rules_for(plan), planner_of(manager), options),
                        kOwn, options.start, seed);
    run_mission(model, rules_for(plan), system, telling);
  }
  if (telling != nullptr) {
    telling->begin = model.guided();
    telling->end = model.world().now();
  }
  return measure(model);
}

}  // namespace culprit::study
