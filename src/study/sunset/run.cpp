#include "study/sunset/run.h"

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

bool is_right_place(const Strategy& strategy, const RuleSet& rules,
                    sunset::model::SunsetModel& model, const sunset::Scenario& scenario) {
  return std::all_of(strategy.components.begin(), strategy.components.end(), [&](ComponentId c) {
    return std::any_of(
        scenario.faults.begin(), scenario.faults.end(), [&](const Fault* fault) {
          return model.has(*fault) && can_be_repaired_at(*fault, rules[c].node);
        });
  });
}

}  // namespace

SunsetRun play(sunset::model::SunsetModel& model, const RuleSet& rules, ManagingSystem& manager,
               const sunset::Scenario& scenario) {
  SunsetRun run;
  run.scenario = scenario;
  run.begin = Time{model.profile().manager_start};
  run.injected = model.inject(scenario);
  run.end = later(run.injected, model.profile().end_of_run);
  model.world().run(run.begin);

  simulation::SimulatedRobot robot(rules, model.world());
  Runtime runtime(manager, robot);
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      run.events.push_back(event);
      if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
        run.was_right_place.push_back(
            is_right_place(rules[chosen->strategy], rules, model, scenario));
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, run.end);

  const sunset::model::Evaluator& evaluator = model.evaluator();
  run.downtime = evaluator.downtime().between_outputs();
  run.honest_downtime = evaluator.downtime().total(run.end);
  run.is_recovered = evaluator.is_well();
  run.recovery = run.is_recovered ? evaluator.last_unwell().value_or(run.injected) - run.injected
                                  : run.end - run.injected;
  return run;
}

}  // namespace culprit::study
