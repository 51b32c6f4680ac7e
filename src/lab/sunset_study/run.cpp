#include "sunset_study/run.h"

#include <algorithm>
#include <atomic>
#include <string_view>

#include "manager/runtime.h"
#include "simulation/simulated_robot.h"

namespace culprit::study {
namespace {

using sunset::Fault;
using sunset::Member;

// Where a fault can be repaired: at its own node, or, a degraded picture, behind it.
bool can_be_repaired_at(const Fault& fault, std::string_view node) {
  if (node == sunset::node_of(fault.member).full()) return true;
  return fault.name == "image_degradation" &&
         (node == sunset::node_of(Member::kImageEnhancement).full() ||
          node == sunset::node_of(Member::kSensorFusion).full());
}

std::vector<const Fault*> present_in(sunset::model::SunsetModel& model,
                                     const sunset::Scenario& scenario) {
  std::vector<const Fault*> present;
  for (const Fault* fault : scenario.faults) {
    if (model.has(*fault)) present.push_back(fault);
  }
  return present;
}

}  // namespace

SunsetRun::Choice judge(StrategyId id, const RuleSet& rules,
                        std::span<const Fault* const> present) {
  const Strategy& strategy = rules[id];
  const auto is_faulty = [&](ComponentId component) {
    return std::any_of(present.begin(), present.end(), [&](const Fault* fault) {
      return can_be_repaired_at(*fault, rules[component].node);
    });
  };
  const auto is_ended = [&](const Fault* fault) {
    return std::find(fault->resolved_by.begin(), fault->resolved_by.end(), strategy.name) !=
           fault->resolved_by.end();
  };
  return {id, std::all_of(strategy.components.begin(), strategy.components.end(), is_faulty),
          std::any_of(present.begin(), present.end(), is_ended)};
}

SunsetRun play(sunset::model::SunsetModel& model, const RuleSet& rules, ManagingSystem& manager,
               const sunset::Scenario& scenario) {
  SunsetRun run;
  run.scenario = scenario;
  run.begin = Time{model.profile().manager_start};
  run.injections = model.inject(scenario);
  const Time injected = run.injections.front().at;
  run.end = later(injected, model.profile().end_of_run);
  model.world().run(run.begin);

  simulation::SimulatedRobot robot(rules, model.world());
  Runtime runtime(manager, robot);
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      run.events.push_back(event);
      if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
        run.choices.push_back(judge(chosen->strategy, rules, present_in(model, scenario)));
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, run.end);

  const sunset::model::Evaluator& evaluator = model.evaluator();
  run.downtime = evaluator.downtime().between_outputs();
  run.honest_downtime = evaluator.downtime().total(run.end);
  run.is_recovered = evaluator.is_well();
  run.recovery =
      run.is_recovered ? evaluator.last_unwell().value_or(injected) - injected : run.end - injected;
  return run;
}

}  // namespace culprit::study
