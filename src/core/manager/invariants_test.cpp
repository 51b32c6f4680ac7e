// Invariants on every robot, whatever breaks: on random ones, in virtual time, with the bayes
// planner.
#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

struct Broken {
  std::string name;
  std::vector<std::string> needs;
  std::vector<std::string> hears;
  std::string rule;
  std::string fault;  // as TestRobot's, or "kill", "stop", "hang", "" (none)
};

// Components that need earlier ones, and subscribe to any others: loops that no failure takes.
std::vector<Broken> random_components() {
  std::vector<Broken> all;
  const int count = *rc::gen::inRange(1, 7);
  for (int i = 0; i < count; ++i) {
    Broken c;
    c.name = "c" + std::to_string(i);
    for (int j = 0; j < count; ++j) {
      const int dice = *rc::gen::inRange(0, 10);
      if (j < i && dice < 3) c.needs.push_back("c" + std::to_string(j));
      if (j != i && dice == 9) c.hears.push_back("c" + std::to_string(j));
    }
    const auto number = [](int most) { return std::to_string(*rc::gen::inRange(1, most)) + " "; };
    c.rule = "RULE Silent" + std::to_string(i) + "\nPOLICIES " +
             *rc::gen::element<std::string>("ERROR", "WARNING", "NON_CRITICAL") +
             " ATTEMPTS 2\nTRIGGER age(/" + c.name + ") > " +
             *rc::gen::element<std::string>("250ms", "350ms", "600ms") + "\nSTRATEGY restart " +
             number(100) + "10\nADAPTATION " + c.name + " restart " + number(10) +
             "\nSTRATEGY redeploy " + number(100) + "10\nADAPTATION " + c.name + " redeploy " +
             number(20) + "\n";
    c.fault = *rc::gen::element<std::string>("", "", "restart", "redeploy", "a person", "kill",
                                             "stop", "hang");
    all.push_back(std::move(c));
  }
  return all;
}

std::string rules_of(const std::vector<Broken>& all) {
  std::string text;
  for (const Broken& c : all) {
    text += "COMPONENT " + c.name + " NODE /" + c.name + " LAUNCH \"" + c.name + "\"\n" + c.rule;
  }
  return text;
}

void set_up(TestRobot& robot, const std::vector<Broken>& all) {
  for (const Broken& c : all) robot.add(c.name, c.needs, "/" + c.name).hears = c.hears;
  robot.discover(2s);
}

void break_it(TestRobot& robot, const std::vector<Broken>& all) {
  for (const Broken& c : all) {
    if (c.fault == "kill") {
      robot.kill(c.name);
    } else if (c.fault == "stop") {
      robot.stop(c.name);
    } else if (c.fault == "hang") {
      robot[c.name].answers = false;
      robot[c.name].fault = "redeploy";
    } else {
      robot[c.name].fault = c.fault;
    }
  }
}

// With an exhausted failure upstream of it.
bool waits_for_person(RuleId rule, const Knowledge& knowledge) {
  const auto& upstream = knowledge.graph.upstream(knowledge.rules[rule].components.front());
  return std::any_of(upstream.begin(), upstream.end(), [&](ComponentId c) {
    return knowledge.states.awaiting_person_at(c, Criticality::kNonCritical, rule).has_value();
  });
}

bool is_settled(const TestRobot& robot, const Knowledge& knowledge) {
  for (std::size_t r = 0; r < robot.rules().rules.size(); ++r) {
    const RulePhase phase = knowledge.states[RuleId(r)].phase;
    if (phase == RulePhase::kAttempting) return false;
    if (phase == RulePhase::kFailing && !waits_for_person(RuleId(r), knowledge)) return false;
  }
  return true;
}

RC_GTEST_PROP(Invariants, EveryFailureIsResolvedExhaustedOrExcused, ()) {
  const auto all = random_components();
  TestRobot robot(rules_of(all));
  set_up(robot, all);
  break_it(robot, all);
  const Knowledge& knowledge = robot.manager().knowledge();
  robot.run_for(5s);
  for (int patience = 0; patience < 100 && !is_settled(robot, knowledge); ++patience)
    robot.run_for(10s);
  // One that is expected to clear looks as if it waited for a person, too.
  robot.run_for(60s);
  for (const std::string& line : robot.said) RC_LOG() << line << "\n";
  RC_ASSERT(is_settled(robot, knowledge));
  const bool needs_a_person =
      std::any_of(all.begin(), all.end(), [](const Broken& c) { return c.fault == "a person"; });
  for (const Broken& c : all) RC_ASSERT(needs_a_person || robot.works(c.name));
}

RC_GTEST_PROP(Invariants, NoStrategyWorksWhereAnotherDoesOrDownstreamOfIt, ()) {
  const auto all = random_components();
  TestRobot robot(rules_of(all));
  const Knowledge& knowledge = robot.manager().knowledge();
  const RuleSet& rules = robot.rules();
  set_up(robot, all);
  robot.after_step = [&] {
    for (const Event& event : robot.manager().events()) {
      const auto* chosen = std::get_if<StrategyChosen>(&event.what);
      if (chosen == nullptr) continue;
      const Strategy& strategy = rules[chosen->strategy];
      for (const RuleId id : knowledge.states.active()) {
        const auto& other = knowledge.states[id].attempt;
        if (!other || other->strategy == chosen->strategy || other->chosen == event.at) continue;
        if (other->stage == Attempt::Stage::kSuspended) continue;
        const ComponentId taken = rules[other->strategy].components.front();
        const ComponentId own = strategy.components.front();
        RC_ASSERT(taken != own);
        // The dead are replaced side by side. And what only waits for its verdict gives way to what
        // is worse, by itself or by what it explains.
        const ProcessState process = knowledge.components[own].process;
        const bool stands_back = other->effective != kNever || process != ProcessState::kRunning;
        const auto& upstream = knowledge.graph.upstream(own);
        RC_ASSERT(stands_back ||
                  std::find(upstream.begin(), upstream.end(), taken) == upstream.end());
      }
    }
  };
  break_it(robot, all);
  robot.run_for(60s);
}

// "At once" is the decision after its detection: it must not wait for a verdict on others, for
// failures that these may explain, or for a more critical failure.
RC_GTEST_PROP(Invariants, TheRepairOfWhatIsKnownToBeDeadBeginsAtOnceWhateverTheLevels, ()) {
  const auto all = random_components();
  TestRobot robot(rules_of(all));
  const Knowledge& knowledge = robot.manager().knowledge();
  set_up(robot, all);
  robot.after_step = [&] {
    for (const Event& event : robot.manager().events()) {
      const auto* detected = std::get_if<FailureDetected>(&event.what);
      if (detected == nullptr) continue;
      const ComponentId component = robot.rules()[detected->rule].components.front();
      if (knowledge.components[component].process != ProcessState::kGone) continue;
      for (const std::string& line : robot.said) RC_LOG() << line << "\n";
      RC_ASSERT(knowledge.states[detected->rule].attempt.has_value());
    }
  };
  break_it(robot, all);
  robot.run_for(3s);
}

RC_GTEST_PROP(Invariants, WhatIsDoneDoesNotDependOnTheOrderOfDeclarations, ()) {
  const auto all = random_components();
  std::vector<Broken> reversed(all.rbegin(), all.rend());
  TestRobot one(rules_of(all));
  TestRobot other(rules_of(reversed));
  for (TestRobot* robot : {&one, &other}) {
    set_up(*robot, all);
    break_it(*robot, all);
    robot->run_for(30s);
  }
  RC_ASSERT(one.asked == other.asked);
}

}  // namespace
}  // namespace culprit::test
