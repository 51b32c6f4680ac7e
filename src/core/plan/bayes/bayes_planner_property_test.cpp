// Invariants of every plan, on random robots: components that depend on each other in any way,
// feedback loops included, rules that touch one or two of them, and failures of any level.
//
// scripts/check-invariants runs a million of them.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/test_scene.h"

namespace culprit {
namespace {

using plan::Scene;

std::string name_of(char prefix, int number) { return prefix + std::to_string(number); }

struct RandomRobot {
  int components = 0;
  std::vector<std::pair<int, int>> links;
  std::vector<std::string> rules;  // the text of each
  std::vector<int> failing;        // rules
  std::vector<int> attempting;     // rules, with their first strategy
  std::vector<int> tried;          // rules, whose first strategy was tried
  bool has_effect = false;         // the strategies under way only wait for their verdict

  // The rules in the order of `order`, the components in the opposite one if `is_reversed`. Then
  // the graph has another past as well: other links came first, and were looked at, and some went.
  Scene scene(const std::vector<int>& order, bool is_reversed) const {
    std::string text;
    for (int i = 0; i < components; ++i) {
      const std::string name = name_of('c', is_reversed ? components - 1 - i : i);
      text += "COMPONENT " + name + " NODE /" + name + " LAUNCH \"" + name + "\"\n";
    }
    for (const int rule : order) text += rules[static_cast<std::size_t>(rule)];
    Scene scene(text);
    if (is_reversed) give_a_past(scene);
    for (const auto& [producer, consumer] : links)
      scene.link(name_of('c', producer), name_of('c', consumer));
    for (const int rule : failing) scene.fail(name_of('R', rule));
    for (const int rule : attempting)
      scene.attempt(name_of('R', rule) + ".first",
                    has_effect ? Attempt::Stage::kWaiting : Attempt::Stage::kAdapting);
    for (const int rule : tried) scene.tried(name_of('R', rule) + ".first");
    return scene;
  }
  Scene scene() const { return scene(in_order(), false); }

  void give_a_past(Scene& scene) const {
    for (auto link = links.rbegin(); link != links.rend(); ++link) {
      scene.link(name_of('c', link->second), name_of('c', link->first));
      scene->graph.condensation();
    }
    for (const auto& [consumer, producer] : links) {
      const std::string topic = "/" + name_of('c', producer) + "/out";
      scene->graph.endpoint_vanished("/" + name_of('c', consumer), EndpointKind::kSubscriber,
                                     topic);
      scene->graph.condensation();
    }
  }

  std::vector<int> in_order() const {
    std::vector<int> order(rules.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    return order;
  }
};

RandomRobot random_robot() {
  RandomRobot robot;
  robot.components = *rc::gen::inRange(1, 8);
  const auto component = rc::gen::inRange(0, robot.components);
  robot.links =
      *rc::gen::container<std::vector<std::pair<int, int>>>(rc::gen::pair(component, component));
  const int rules = *rc::gen::inRange(1, 8);
  std::set<int> reserved;
  for (int r = 0; r < rules; ++r) {
    const int first = *component;
    const int second = *component;
    const std::string level = *rc::gen::element<std::string>("ERROR", "WARNING", "NON_CRITICAL");
    const auto number = [](int least, int most) {
      return std::to_string(*rc::gen::inRange(least, most)) + " ";
    };
    robot.rules.push_back("RULE " + name_of('R', r) + "\nPOLICIES " + level +
                          "\nTRIGGER x > 1\nSTRATEGY first " + number(1, 100) + "10\nADAPTATION " +
                          name_of('c', first) + " restart " + number(1, 20) + "\nSTRATEGY second " +
                          number(1, 100) + "10\nADAPTATION " + name_of('c', second) + " redeploy " +
                          number(1, 20) + "\n");
    switch (*rc::gen::inRange(0, 4)) {
      case 0:
        break;  // it is well
      case 1:
        if (reserved.insert(first).second) robot.attempting.push_back(r);
        break;
      case 2:
        robot.tried.push_back(r);
        [[fallthrough]];
      default:
        robot.failing.push_back(r);
    }
  }
  robot.has_effect = *rc::gen::arbitrary<bool>();
  return robot;
}

Objective random_objective() {
  return *rc::gen::element(Objective::kBalanced, Objective::kDowntime, Objective::kAdaptations,
                           Objective::kRedeployments);
}

bool depends(Scene& scene, const Strategy& consumer, const Strategy& producer) {
  return std::any_of(
      consumer.components.begin(), consumer.components.end(), [&](ComponentId component) {
        const auto& upstream = scene->graph.upstream(component);
        return std::any_of(upstream.begin(), upstream.end(), [&](ComponentId c) {
          return std::binary_search(producer.components.begin(), producer.components.end(), c);
        });
      });
}

bool is_in_circle(Scene& scene, ComponentId component) {
  const auto& upstream = scene->graph.upstream(component);
  return std::any_of(upstream.begin(), upstream.end(), [&](ComponentId c) {
    const auto& further = scene->graph.upstream(c);
    return std::find(further.begin(), further.end(), component) != further.end();
  });
}

// A component in a feedback loop is upstream of itself.
bool is_upstream(Scene& scene, const Rule& rule, const Rule& other) {
  Strategy producer;
  producer.components = rule.components;
  Strategy consumer;
  consumer.components = other.components;
  const auto& all = rule.components;
  return depends(scene, consumer, producer) ||
         std::any_of(all.begin(), all.end(), [&](ComponentId c) {
           return std::binary_search(other.components.begin(), other.components.end(), c) &&
                  is_in_circle(scene, c);
         });
}

// Its own, or that of the worst failure which it may be the cause of, round however many corners.
Criticality level_of(Scene& scene, RuleId rule) {
  std::set<RuleId> explained{rule};
  for (std::size_t before = 0; before < explained.size();) {
    before = explained.size();
    for (const RuleId effect : scene->states.active()) {
      const bool is_one = std::any_of(explained.begin(), explained.end(), [&](RuleId cause) {
        return is_upstream(scene, scene.rules()[cause], scene.rules()[effect]);
      });
      if (is_one) explained.insert(effect);
    }
  }
  Criticality worst = Criticality::kNonCritical;
  for (const RuleId each : explained)
    worst = std::max(worst, scene.rules()[each].policies.criticality);
  return worst;
}

bool shares(const Strategy& a, const Strategy& b) {
  return std::any_of(a.components.begin(), a.components.end(), [&](ComponentId c) {
    return std::binary_search(b.components.begin(), b.components.end(), c);
  });
}

std::vector<const Strategy*> chosen(const Scene& scene) {
  std::vector<const Strategy*> all;
  for (const Decision& decision : scene.decisions()) {
    if (decision.chosen) all.push_back(&scene.rules()[*decision.chosen]);
  }
  return all;
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, NeverInterferesWithItself, ()) {
  Scene scene = random_robot().scene();
  scene.plan(BayesPlanner(random_objective()));
  const auto all = chosen(scene);
  for (const Strategy* a : all) {
    for (const Strategy* b : all) {
      RC_ASSERT(a == b || (!shares(*a, *b) && !depends(scene, *a, *b)));
    }
  }
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, LeavesAloneWhatIsBeingAdaptedAndWhatDependsOnIt, ()) {
  Scene scene = random_robot().scene();
  scene.plan(BayesPlanner(random_objective()));
  for (const RuleId id : scene->states.active()) {
    const auto& attempt = scene->states[id].attempt;
    if (!attempt) continue;
    const Strategy& under_way = scene.rules()[attempt->strategy];
    for (const Strategy* strategy : chosen(scene)) {
      const bool is_lesser = level_of(scene, id) < level_of(scene, strategy->rule);
      const bool stands_back = attempt->stage == Attempt::Stage::kWaiting && is_lesser;
      RC_ASSERT(stands_back ||
                (!shares(*strategy, under_way) && !depends(scene, *strategy, under_way)));
    }
  }
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, NeverWaitsForNothing, ()) {
  RandomRobot robot = random_robot();
  robot.attempting.clear();
  Scene scene = robot.scene();
  const std::string plan = scene.plan(BayesPlanner(random_objective()));
  RC_ASSERT(plan.empty() == robot.failing.empty());
}

// A strategy that adapts what a more critical failure touches or depends on would delay it. Unless
// its own failure may be the cause of the other: then it is as critical.
RC_GTEST_PROP(BayesPlannerOnRandomRobots, NeverDelaysTheMoreCritical, ()) {
  const RandomRobot robot = random_robot();
  Scene scene = robot.scene();
  scene.plan(BayesPlanner(random_objective()));
  for (const Strategy* strategy : chosen(scene)) {
    const Criticality level = level_of(scene, strategy->rule);
    for (const int failing : robot.failing) {
      const Rule& rule = scene.rules()[scene.rule(name_of('R', failing))];
      if (rule.policies.criticality <= level) continue;
      Strategy touched;
      touched.components = rule.components;
      RC_ASSERT(!shares(touched, *strategy) && !depends(scene, touched, *strategy));
    }
  }
}

// A robot without feedback loops, where each failure is of one component.
struct RandomPipeline {
  Scene scene;
  std::vector<int> failing;

  bool has_failure_upstream(int rule) {
    const auto& upstream = scene->graph.upstream(scene.component(name_of('c', rule)));
    return std::any_of(failing.begin(), failing.end(), [&](int other) {
      const ComponentId c = scene.component(name_of('c', other));
      return std::find(upstream.begin(), upstream.end(), c) != upstream.end();
    });
  }
  std::optional<StrategyId> chosen_for(int rule) const {
    return scene.decision(name_of('R', rule)).chosen;
  }
};

RandomPipeline random_pipeline() {
  const int components = *rc::gen::inRange(1, 8);
  std::string text;
  for (int i = 0; i < components; ++i) {
    const auto level = *rc::gen::element<std::string>("ERROR", "WARNING", "NON_CRITICAL");
    text += plan::failure_of(name_of('c', i), name_of('R', i), level);
  }
  RandomPipeline robot{Scene(text), {}};
  for (int i = 0; i < components; ++i) {
    for (int j = 0; j < i; ++j) {
      if (*rc::gen::inRange(0, 3) == 0) robot.scene.link(name_of('c', j), name_of('c', i));
    }
    if (*rc::gen::inRange(0, 3) != 0) robot.failing.push_back(i);
  }
  for (const int rule : robot.failing) robot.scene.fail(name_of('R', rule));
  return robot;
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, NeverHoldsBackTheTopmostCauseWhateverTheLevels, ()) {
  RandomPipeline robot = random_pipeline();
  robot.scene.plan(BayesPlanner(random_objective()));
  for (const int rule : robot.failing)
    RC_ASSERT(robot.chosen_for(rule).has_value() == !robot.has_failure_upstream(rule));
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, ReplacesAllThatIsKnownToBeDeadAtOnce, ()) {
  RandomPipeline robot = random_pipeline();
  std::set<int> dead;
  for (const int rule : robot.failing) {
    if (*rc::gen::arbitrary<bool>()) dead.insert(rule);
  }
  for (const int rule : dead) robot.scene.process(name_of('c', rule), ProcessState::kGone);
  const bool is_busy = *rc::gen::arbitrary<bool>();
  if (is_busy && !robot.failing.empty() && !dead.contains(robot.failing.front()))
    robot.scene.attempt(name_of('R', robot.failing.front()) + ".restart");
  robot.scene.plan(BayesPlanner(random_objective()));
  for (const int rule : dead)
    RC_ASSERT(robot.chosen_for(rule) == robot.scene.strategy(name_of('R', rule) + ".redeploy"));
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, ReplacesNothingWhoseFailureAnExhaustedOneExplains, ()) {
  RandomPipeline robot = random_pipeline();
  const int exhausted =
      *rc::gen::inRange(0, static_cast<int>(robot.scene.rules().components.size()));
  robot.scene.exhaust(name_of('R', exhausted));
  robot.scene.plan(BayesPlanner(random_objective()));
  const ComponentId cause = robot.scene.component(name_of('c', exhausted));
  for (const Decision& decision : robot.scene.decisions()) {
    const ComponentId touched = robot.scene.rules()[decision.rule].components.front();
    const auto& upstream = robot.scene->graph.upstream(touched);
    const bool is_explained = std::find(upstream.begin(), upstream.end(), cause) != upstream.end();
    RC_ASSERT(!is_explained || !decision.chosen);
    RC_ASSERT(!is_explained || !decision.is_spent);
  }
}

RC_GTEST_PROP(BayesPlannerOnRandomRobots, DecidesTheSameInWhateverOrderRulesAreDeclaredAndLinksCome,
              ()) {
  const RandomRobot robot = random_robot();
  const BayesPlanner planner(random_objective());
  std::vector<int> order = robot.in_order();
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[*rc::gen::inRange<std::size_t>(0, i)]);
  Scene one = robot.scene();
  Scene other = robot.scene(order, true);
  RC_ASSERT(one.plan(planner) == other.plan(planner));
}

}  // namespace
}  // namespace culprit
