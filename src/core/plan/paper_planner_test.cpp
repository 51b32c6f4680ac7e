#include "plan/paper_planner.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/cost.h"

namespace culprit {
namespace {

// A -> B -> C (C depends on B, B on A), a rule for each, and one of a lower level for B and D.
constexpr const char* kRules = R"(
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
COMPONENT c NODE /c LAUNCH "c"
COMPONENT d NODE /d LAUNCH "d"
RULE A
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY cheap 60 10
      ADAPTATION a restart 2
    STRATEGY dear 90 10
      ADAPTATION a redeploy 10
RULE B
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY cheap 60 10
      ADAPTATION b restart 2
RULE C
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY cheap 60 10
      ADAPTATION c restart 2
RULE Bad
  POLICIES WARNING
  TRIGGER x > 1
    STRATEGY first 80 10
      ADAPTATION b set_parameter p 1 2
    STRATEGY second 50 10
      ADAPTATION d activate 2
      ADAPTATION b change_communication input /x 2
)";

class PaperPlannerTest : public testing::Test {
 protected:
  PaperPlannerTest() : rules_(*check(Source("test.rules", kRules)).rules), knowledge_(rules_) {
    for (std::size_t c = 0; c < rules_.components.size(); ++c) {
      knowledge_.components[ComponentId(c)].alive = true;
      knowledge_.components[ComponentId(c)].lifecycle = Lifecycle::kActive;
      knowledge_.graph.node_appeared(rules_.components[c].node);
    }
    knowledge_.components[ComponentId(3)].lifecycle = Lifecycle::kInactive;
    link("/a", "/ab", "/b");
    link("/b", "/bc", "/c");
  }

  void link(const std::string& producer, const std::string& topic, const std::string& consumer) {
    knowledge_.graph.endpoint_appeared(producer, EndpointKind::kPublisher, topic);
    knowledge_.graph.endpoint_appeared(consumer, EndpointKind::kSubscriber, topic);
  }

  RuleId rule(const std::string& name) const {
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
      if (rules_.rules[r].name == name) return RuleId(r);
    }
    return {};
  }

  // "A.cheap C.cheap": what is chosen when these rules fail, in the order of the decisions.
  std::string plan(const std::vector<std::string>& failing, PaperSwitches switches = {}) {
    for (const std::string& name : failing) {
      if (knowledge_.states[rule(name)].phase == RulePhase::kQuiet)
        knowledge_.states.enter(rule(name), RulePhase::kFailing);
    }
    std::vector<RuleId> ids;
    for (const RuleId id : knowledge_.states.active()) {
      if (knowledge_.states[id].phase == RulePhase::kFailing) ids.push_back(id);
    }
    decisions_ = PaperPlanner(switches).plan(ids, knowledge_);
    std::string out;
    for (const Decision& decision : decisions_) {
      if (!decision.chosen) continue;
      out += (out.empty() ? "" : " ") + rules_[decision.rule].name + "." +
             rules_[*decision.chosen].name;
    }
    return out;
  }

  const Candidate& candidate(const std::string& rule_name, const std::string& strategy) const {
    for (const Decision& decision : decisions_) {
      for (const Candidate& c : decision.candidates) {
        if (rules_[decision.rule].name == rule_name && rules_[c.strategy].name == strategy)
          return c;
      }
    }
    throw std::logic_error("no such candidate");
  }

  RuleSet rules_;
  Knowledge knowledge_;
  std::vector<Decision> decisions_;
};

TEST(Cost, IsThePapersEquation) {
  EXPECT_DOUBLE_EQ(plan::cost(percent(80), Cycles{2}, Cycles{10}), 0.2 + 0.2);
  EXPECT_DOUBLE_EQ(plan::cost(percent(100), Cycles{10}, Cycles{10}), 1);
  EXPECT_DOUBLE_EQ(plan::cost_without_impact(percent(80)), 1 - 0.8);
}

TEST_F(PaperPlannerTest, TakesTheCheapestStrategy) {
  EXPECT_EQ(plan({"A"}), "A.cheap");
  EXPECT_EQ(candidate("A", "dear").excluded, Condition::kOneEach);
}

TEST_F(PaperPlannerTest, WithoutImpactTakesTheLikeliest) {
  EXPECT_EQ(plan({"A"}, {.impact = false}), "A.dear");
}

TEST_F(PaperPlannerTest, Condition1SkipsWhatWasTried) {
  knowledge_.states.state(rule("A")).search.tried[0] = true;
  EXPECT_EQ(plan({"A"}), "A.dear");
  knowledge_.states.state(rule("A")).search.tried[1] = true;
  EXPECT_EQ(plan({"A"}), "");
  EXPECT_TRUE(decisions_[0].is_spent);
}

TEST_F(PaperPlannerTest, Condition2SkipsWhatMakesNoSense) {
  knowledge_.components[ComponentId(0)].alive = false;
  EXPECT_EQ(plan({"A"}), "A.dear") << "a dead process cannot restart its node";
  EXPECT_EQ(candidate("A", "cheap").excluded, Condition::kInvalid);
  knowledge_.components[ComponentId(3)].lifecycle = Lifecycle::kActive;
  knowledge_.states.state(rule("Bad")).search.tried[0] = true;
  EXPECT_EQ(plan({"Bad"}), "A.dear") << "an active component cannot be activated";
}

TEST_F(PaperPlannerTest, Condition3SkipsComponentsUnderAdaptation) {
  plan({"B"});
  RuleState& state = knowledge_.states.state(rule("B"));
  state.attempt.emplace();
  state.attempt->strategy = rules_.rules[rule("B").index].strategies[0];
  knowledge_.states.enter(rule("B"), RulePhase::kAttempting);
  EXPECT_EQ(plan({"Bad"}), "");
  EXPECT_EQ(candidate("Bad", "first").excluded, Condition::kAdapting);
  EXPECT_FALSE(decisions_[0].is_spent) << "it only has to wait";
}

TEST_F(PaperPlannerTest, Condition4SkipsComponentsOfStrategiesChosenJustNow) {
  EXPECT_EQ(plan({"B", "Bad"}), "B.cheap");
  EXPECT_EQ(candidate("Bad", "first").excluded, Condition::kAffected);
  EXPECT_EQ(candidate("Bad", "second").excluded, Condition::kAffected);
}

TEST_F(PaperPlannerTest, Condition5SkipsWhatDependsOnAPossibleCause) {
  EXPECT_EQ(plan({"A", "B", "C"}), "A.cheap");
  EXPECT_EQ(candidate("C", "cheap").excluded, Condition::kDependency);
  EXPECT_EQ(*candidate("B", "cheap").failure, rule("A"));
}

TEST_F(PaperPlannerTest, Condition5LooksThroughHealthyComponents) {
  EXPECT_EQ(plan({"A", "C"}), "A.cheap");
}

TEST_F(PaperPlannerTest, Condition5IgnoresLowerLevels) {
  EXPECT_EQ(plan({"Bad", "C"}), "C.cheap Bad.first")
      << "a warning upstream does not hold back an error";
}

TEST_F(PaperPlannerTest, Condition5LooksAtAllLevelsWithoutCriticality) {
  EXPECT_EQ(plan({"Bad", "C"}, {.criticality = false}), "Bad.first");
}

TEST_F(PaperPlannerTest, ActsEverywhereWithoutDependencies) {
  EXPECT_EQ(plan({"A", "B", "C"}, {.dependencies = false}), "A.cheap B.cheap C.cheap");
}

TEST_F(PaperPlannerTest, AFailureDoesNotHoldBackItself) {
  link("/d", "/db", "/b");  // b reads d now, and rule Bad touches both
  EXPECT_EQ(plan({"Bad"}), "Bad.first");
}

TEST_F(PaperPlannerTest, Condition5HoldsForAnExhaustedFailureWhileItIsThere) {
  knowledge_.states.enter(rule("A"), RulePhase::kExhausted);
  knowledge_.states.state(rule("A")).detection.trigger = Slot::of(true);
  EXPECT_EQ(plan({"B"}), "");
  EXPECT_EQ(candidate("B", "cheap").excluded, Condition::kDependency);
  EXPECT_EQ(candidate("B", "cheap").failure, rule("A"));
  EXPECT_FALSE(decisions_[0].is_spent) << "it waits for a person";
  EXPECT_EQ(plan({"B"}, {.dependencies = false}), "B.cheap") << "who knows no causes";
  knowledge_.states.state(rule("A")).detection.trigger = Slot::of(false);
  EXPECT_EQ(plan({"B"}), "B.cheap");
}

TEST_F(PaperPlannerTest, TriesOneReconfigurationBesideAnExhaustedCause) {
  knowledge_.states.enter(rule("A"), RulePhase::kExhausted);
  knowledge_.states.state(rule("A")).detection.trigger = Slot::of(true);
  EXPECT_EQ(plan({"Bad"}), "Bad.first");
  knowledge_.states.state(rule("Bad")).search.tried[0] = true;
  EXPECT_EQ(plan({"Bad"}), "") << "once";
}

TEST_F(PaperPlannerTest, FollowsBeliefsAsTheyChange) {
  knowledge_.beliefs.set(StrategyId(0), {1, 99});
  EXPECT_EQ(plan({"A"}), "A.dear") << "0.1 + 1 is less than 0.99 + 0.2";
}

}  // namespace
}  // namespace culprit
