// The goals of an adaptation, and the goals that undo it.
#include "execute/goal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::execute {
namespace {

using Kind = ParameterGoal::Kind;

struct Goals {
  RuleSet rules = *check(Source("goals.rules",
                                "COMPONENT c NODE /c LAUNCH \"c\"\nRULE Dead\nPOLICIES ERROR\n"
                                "TRIGGER !alive(c)\nSTRATEGY again 90 10\nADAPTATION c redeploy 5\n"
                                "STRATEGY begin 90 10\nADAPTATION c start 5\n"
                                "STRATEGY less 90 10\nADAPTATION c decrease_parameter gain 2 5\n"))
                       .rules;
  Knowledge knowledge{rules};

  std::vector<Goal> of(std::size_t strategy) {
    return *goals_of(rules.strategies[strategy].adaptations.front(), knowledge);
  }
  void intended(Lifecycle state) {
    knowledge.components[ComponentId(0)].intended_lifecycle = state;
  }
};

Reply read(decltype(Reply::value) value) { return {{}, Outcome::kDone, std::move(value), ""}; }

TEST(Goal, OfARedeployIsTheLifecycleThatWasIntended) {
  Goals goals;
  EXPECT_EQ(goals.of(0).size(), 2u) << "it has no lifecycle";
  for (const Lifecycle state : {Lifecycle::kActive, Lifecycle::kInactive}) {
    goals.intended(state);
    const auto all = goals.of(0);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_TRUE(std::holds_alternative<GoneGoal>(all[0]));
    EXPECT_TRUE(std::holds_alternative<PresentGoal>(all[1]));
    EXPECT_EQ(std::get<LifecycleGoal>(all[2]).target, state);
  }
  goals.intended(Lifecycle::kUnconfigured);
  EXPECT_EQ(goals.of(0).size(), 2u) << "it stays as it comes up";
}

TEST(Goal, OfARedeployedUnitIsAnyProcessButTheOneThatIsThere) {
  const RuleSet rules =
      *check(Source("unit.rules",
                    "COMPONENT c NODE /c UNIT c.service\nRULE Dead\nPOLICIES ERROR\n"
                    "TRIGGER !alive(c)\nSTRATEGY again 90 10\nADAPTATION c redeploy 5\n"))
           .rules;
  Knowledge knowledge{rules};
  knowledge.components[ComponentId(0)].pid = 7;
  const auto goals = goals_of(rules.strategies[0].adaptations.front(), knowledge);
  ASSERT_EQ(goals->size(), 2u);
  EXPECT_EQ(std::get<GoneGoal>((*goals)[0]).pid, 7);
  EXPECT_EQ(std::get<PresentGoal>((*goals)[1]).instead_of, 7);
}

TEST(Goal, OfAUnitOnAnotherComputerIsANodeThatJoinedLater) {
  const RuleSet rules =
      *check(Source("unit.rules",
                    "COMPONENT c NODE /c UNIT c.service HOST rover2\nRULE Dead\nPOLICIES ERROR\n"
                    "TRIGGER !alive(c)\nSTRATEGY again 90 10\nADAPTATION c redeploy 5\n"))
           .rules;
  Knowledge knowledge{rules};
  knowledge.components[ComponentId(0)].node_seen = Time(std::chrono::seconds(4));
  const auto goals = goals_of(rules.strategies[0].adaptations.front(), knowledge);
  ASSERT_EQ(goals->size(), 2u);
  EXPECT_EQ(std::get<PresentGoal>((*goals)[1]).instead_of_seen, Time(std::chrono::seconds(4)));
}

TEST(Goal, OfAStartIsToBeActive) {
  Goals goals;
  EXPECT_EQ(goals.of(1).size(), 1u);
  goals.intended(Lifecycle::kInactive);
  ASSERT_EQ(goals.of(1).size(), 2u);
  EXPECT_EQ(std::get<LifecycleGoal>(goals.of(1)[1]).target, Lifecycle::kActive);
}

TEST(Goal, LeavesADriverOfWhichNothingIsKnownTheTimeToShowItself) {
  using namespace std::chrono_literals;
  using Driver = ComingUp::Driver;
  Goals goals;
  goals.intended(Lifecycle::kActive);
  ComingUp& before = goals.knowledge.components[ComponentId(0)].coming_up;
  const auto grace = [&] { return std::get<LifecycleGoal>(goals.of(0)[2]).grace; };
  EXPECT_EQ(grace(), 1s) << "the impact";
  before = {Driver::kUnknown, 3s, {}};
  EXPECT_EQ(grace(), 3s);
  before = {Driver::kUnknown, 400ms, {}};
  EXPECT_EQ(grace(), 600ms) << "until the impact is over";
  before = {Driver::kUnknown, 2min, {}};
  EXPECT_EQ(grace(), 1min) << "for ever is too long";
  before = {Driver::kOther, 3s, 2s};
  EXPECT_EQ(grace(), 5s);
  before = {Driver::kCulprit, 3s, 2s};
  EXPECT_EQ(grace(), 0s) << "nobody else brought it up";
}

TEST(Goal, OfADecreaseIsToAddLess) {
  const auto goal = std::get<ParameterGoal>(Goals().of(2).front());
  EXPECT_EQ(goal.kind, Kind::kAdd);
  EXPECT_EQ(goal.value, Value(std::int64_t{-2}));
}

TEST(Undoing, BringsBackWhatWasReadBefore) {
  const ParameterGoal set{"gain", Value(0.7), Kind::kSet, {}};
  const auto parameter = undoing(set, AdaptationType::kSetParameter, read(Value(0.5)));
  ASSERT_TRUE(parameter);
  EXPECT_EQ(std::get<ParameterGoal>(*parameter).value, Value(0.5));
  EXPECT_EQ(std::get<ParameterGoal>(*parameter).kind, Kind::kRestore);
  const auto lifecycle = undoing(LifecycleGoal{Lifecycle::kInactive, {}},
                                 AdaptationType::kDeactivate, read(Lifecycle::kActive));
  ASSERT_TRUE(lifecycle);
  EXPECT_EQ(std::get<LifecycleGoal>(*lifecycle).target, Lifecycle::kActive);
}

TEST(Undoing, BringsBackAModeThatWasKnown) {
  const ModeGoal fast{"fast"};
  const auto mode = undoing(fast, AdaptationType::kChangeMode, read(Value(std::string("slow"))));
  ASSERT_TRUE(mode);
  EXPECT_EQ(std::get<ModeGoal>(*mode).mode, "slow");
  for (const char* unknown : {"", kUnknownMode})
    EXPECT_FALSE(undoing(fast, AdaptationType::kChangeMode, read(Value(std::string(unknown)))));
  EXPECT_FALSE(undoing(fast, AdaptationType::kChangeMode, read({})));
}

TEST(Undoing, LeavesWhatIsNoStateToGoBackTo) {
  const ParameterGoal set{"gain", Value(0.7), Kind::kSet, {}};
  EXPECT_FALSE(undoing(set, AdaptationType::kSetParameter, read(Value(std::nan("")))));
  EXPECT_FALSE(undoing(LifecycleGoal{Lifecycle::kActive, {}}, AdaptationType::kRestart,
                       read(Lifecycle::kActive)))
      << "a restart leaves it where it was";
  EXPECT_FALSE(undoing(PresentGoal{}, AdaptationType::kRedeploy, read({})));
}

}  // namespace
}  // namespace culprit::execute
