#include "rule_test/state.h"

#include <algorithm>
#include <atomic>

#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/passive_planner.h"
#include "rule_test/reader.h"
#include "rule_test/restraint.h"
#include "rule_test/scripted_robot.h"

namespace culprit::rule_test {
namespace {

// When the last thing happens that the state says.
Duration last_change(const Scenario& scenario) {
  Duration last{};
  for (const Incident& incident : scenario.incidents) last = std::max(last, incident.at);
  for (const Course& course : scenario.courses) {
    for (const Stretch& stretch : course.stretches)
      last = std::max({last, stretch.from, stretch.until.value_or(Duration::zero())});
  }
  return std::min(last, kLongestRun);
}

// How long a value must last until no rule waits for it any more.
Duration longest_wait(const RuleSet& rules) {
  Duration window{};
  for (const Input& input : rules.inputs) {
    window = std::max(window, input.window);
    if (input.kind == Input::Kind::kAge && !input.thresholds.empty())
      window = std::max(window, from_seconds(input.thresholds.back()));
  }
  for (const Signal& signal : rules.signals)
    window = std::max(window, signal.stale.value_or(Duration::zero()));
  return std::min(longest_detection(rules), kLongestRun) + std::min(window, kLongestRun);
}

void learn(Knowledge& knowledge, const State::Experience& experience) {
  Belief belief = knowledge.beliefs[experience.strategy];
  belief.alpha += experience.helped;
  belief.beta += experience.did_not_help;
  knowledge.beliefs.set(experience.strategy, belief);
}

}  // namespace

Duration moment_of(const State& state, const RuleSet& rules) {
  if (state.moment) return *state.moment;
  constexpr Duration kMargin = std::chrono::seconds(1);
  const Duration moment =
      last_change(state.scenario) + Manager::kDiscovery + longest_wait(rules) + kMargin;
  return std::min(moment, kLongestRun);
}

Watched watch(const State& state, const RuleSet& rules) {
  ScriptedRobot robot(rules, state.scenario);
  Manager::Options options;
  options.governor = restraint();
  Manager manager(rules, std::make_unique<PassivePlanner>(), options);
  manager.remember(robot.declared());
  Runtime runtime(manager, robot);
  const std::atomic<bool> never = false;
  runtime.run(never, Time{moment_of(state, rules)});

  Watched watched{std::make_unique<Knowledge>(rules, manager.knowledge()), manager.plannable(),
                  manager.held_back(), robot.now()};
  Knowledge& knowledge = *watched.knowledge;
  for (const StrategyId strategy : state.tried) knowledge.states.set_tried(strategy, true);
  for (const State::Experience& experience : state.experiences) learn(knowledge, experience);
  return watched;
}

}  // namespace culprit::rule_test
