#include "rule_test/runner.h"

#include <atomic>

#include "manager/manager.h"
#include "manager/runtime.h"
#include "rule_test/bag_run.h"
#include "rule_test/restraint.h"
#include "rule_test/scripted_robot.h"

namespace culprit::rule_test {
namespace {

Result run_script(const RuleSet& rules, const Suite& suite, const Test& test,
                  std::unique_ptr<const Planner> planner) {
  Scenario scenario = suite.shared;
  scenario.append(test.scenario);
  ScriptedRobot robot(rules, scenario);
  Manager::Options options;
  options.governor = restraint();
  Manager manager(rules, std::move(planner), options);
  manager.remember(robot.declared());
  Result result{test.name, test.length, {}, {}};

  Runtime runtime(manager, robot);
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      robot.hear(event);
      result.events.push_back(event);
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, Time{test.length});
  return result;
}

}  // namespace

Result run_test(const RuleSet& rules, const Suite& suite, const Test& test,
                std::unique_ptr<const Planner> planner) {
  Result result = test.bag.empty() ? run_script(rules, suite, test, std::move(planner))
                                   : run_bag_test(rules, test, std::move(planner));
  if (!result.is_ok()) return result;
  const std::vector<Event> preferred =
      test.bag.empty() ? std::vector<Event>() : with_preferred(result.events);
  for (const Expectation& expectation : test.expectations) {
    const bool is_blame = expectation.kind == Expectation::Kind::kBlamed && !test.bag.empty();
    if (auto instead = disappointment(expectation, is_blame ? preferred : result.events, rules))
      result.disappointments.push_back({expectation.span, std::move(*instead)});
  }
  return result;
}

}  // namespace culprit::rule_test
