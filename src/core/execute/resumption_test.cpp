// A strategy that an earlier process of culprit did not live to end is finished or undone.
#include "execute/resumption.h"

#include <gtest/gtest.h>

#include "execute/strategy_executor.h"
#include "language/checker.h"

namespace culprit::execute {
namespace {

using namespace std::chrono_literals;

struct Left {
  RuleSet rules =
      *check(Source("left.rules",
                    "COMPONENT c NODE /c LAUNCH \"c\"\nRULE Bad\nPOLICIES ERROR\nTRIGGER x > 1\n"
                    "STRATEGY tune 90 10\nADAPTATION c set_parameter gain 0.7 5\n"
                    "ADAPTATION c deactivate 5\n"
                    "STRATEGY again 90 10\nADAPTATION c redeploy 5\n"))
           .rules;
  Knowledge knowledge{rules};
  StrategyId tune{0};
  StrategyId again{1};
  ComponentId c{0};

  StrategyExecutor executor() {
    return {knowledge,
            {Attempts(knowledge.states), knowledge.components, knowledge.signals,
             knowledge.outcomes, knowledge.rivals, knowledge.events}};
  }

  // A request that went out for an adaptation of `strategy`, and what it found before.
  Interrupted::Request request(StrategyId strategy, std::uint32_t adaptation,
                               decltype(Command::what) what, decltype(Purpose::before) before,
                               std::optional<Outcome> outcome = Outcome::kDone) {
    return {{{7}, c, std::move(what), 1s, Purpose{strategy, adaptation, false, std::move(before)}},
            outcome};
  }
  Interrupted tuned() {
    return {tune,
            1,
            false,
            {request(tune, 0, SetParameter{"gain", Value(0.7)}, Value(0.5)),
             request(tune, 1, ChangeLifecycle{Transition::kDeactivate}, Lifecycle::kActive)}};
  }
};

TEST(Resumption, BeginsWhenTheRobotHadTheTimeToShowItself) {
  Left left;
  StrategyExecutor executor = left.executor();
  executor.resume(left.tuned(), Time(10s), Time(12s));
  EXPECT_EQ(executor.next_deadline(), Time(12s));
}

// No outcome is learned from it, because culprit did not watch meanwhile; its failure stays the
// same.
TEST(Resumption, IsAnAttemptAtItsFailureOfWhichNothingIsLearned) {
  Left left;
  StrategyExecutor executor = left.executor();
  executor.resume(left.tuned(), Time(10s), Time(12s));
  const auto& attempt = left.knowledge.states[left.rules[left.tune].rule].attempt;
  ASSERT_TRUE(attempt);
  EXPECT_FALSE(attempt->has_no_failure);
  EXPECT_TRUE(attempt->is_ambiguous);
}

TEST(Resumption, BringsBackAllThatWasChangedIfTheStrategyDoesNotHelp) {
  Left left;
  const std::vector<Undo> undo = undo_of(left.tuned(), left.knowledge);
  ASSERT_EQ(undo.size(), 2u);
  const auto& parameter = std::get<ParameterGoal>(undo[0].goal);
  EXPECT_EQ(parameter.name, "gain");
  EXPECT_EQ(parameter.value, Value(0.5));
  EXPECT_EQ(parameter.kind, ParameterGoal::Kind::kRestore);
  EXPECT_EQ(std::get<LifecycleGoal>(undo[1].goal).target, Lifecycle::kActive);
}

TEST(Resumption, UndoesNoUndoing) {
  Left left;
  Interrupted tuned = left.tuned();
  for (auto& request : tuned.requests) request.command.purpose.undoes = true;
  EXPECT_TRUE(undo_of(tuned, left.knowledge).empty());
}

// Lets the executor go on with a robot that obeys; gives how often something was changed.
int changes_of(StrategyExecutor& executor, Time now) {
  int changes = 0;
  Lifecycle state = Lifecycle::kInactive;
  Value gain = 0.7;
  for (int step = 0; step < 100; ++step, now += 50ms) {
    std::vector<Command> commands;
    executor.advance(now, commands);
    for (const Command& command : commands) {
      Reply reply{command.id, Outcome::kDone, {}, ""};
      if (const auto* set = std::get_if<SetParameter>(&command.what)) {
        gain = set->value;
      } else if (const auto* change = std::get_if<ChangeLifecycle>(&command.what)) {
        state =
            change->transition == Transition::kActivate ? Lifecycle::kActive : Lifecycle::kInactive;
      }
      if (!is_read(command)) ++changes;
      if (std::holds_alternative<ReadLifecycle>(command.what)) reply.value = state;
      if (std::holds_alternative<ReadParameter>(command.what)) reply.value = gain;
      executor.answered(reply, now);
    }
  }
  EXPECT_EQ(state, Lifecycle::kActive);
  EXPECT_EQ(gain, Value(0.5));
  return changes;
}

TEST(Resumption, GoesOnUndoingAStrategyThatHadFailed) {
  Left left;
  StrategyExecutor executor = left.executor();
  Interrupted tuned = left.tuned();
  tuned.has_failed = true;
  tuned.adaptations_done = 2;
  executor.resume(tuned, Time{100s}, Time{105s});
  std::vector<Command> early;
  executor.advance(Time{104s}, early);
  EXPECT_TRUE(early.empty()) << "the robot has not shown itself yet";
  EXPECT_EQ(changes_of(executor, Time{105s}), 2) << "each once";
  EXPECT_TRUE(left.knowledge.states.is_tried(left.tune));
}

// A redeploy is not undone: its component is free for another strategy.
TEST(Resumption, IsOverIfItHadFailedAndThereIsNothingToUndo) {
  Left left;
  StrategyExecutor executor = left.executor();
  Interrupted again{left.again,
                    1,
                    true,
                    {left.request(left.again, 0, StopProcess{42}, Lifecycle::kActive),
                     left.request(left.again, 0, StartProcess{}, Lifecycle::kActive)}};
  executor.resume(again, Time{100s}, Time{105s});
  EXPECT_EQ(left.knowledge.states.attempt_of(left.again), nullptr);
  again.has_failed = false;
  executor.resume(again, Time{100s}, Time{105s});
  EXPECT_NE(left.knowledge.states.attempt_of(left.again), nullptr) << "that is to be proven";
}

TEST(Resumption, StartsNoProcessOfWhichNobodyKnowsWhetherItWasStarted) {
  Left left;
  const Interrupted started{
      left.again,
      0,
      false,
      {left.request(left.again, 0, StopProcess{42}, Lifecycle::kActive),
       left.request(left.again, 0, StartProcess{}, Lifecycle::kActive, std::nullopt)}};
  const Resumption rest = resumption_of(started, left.knowledge);
  ASSERT_EQ(rest.goals.size(), 2u) << "the old one was told to go, and was seen to";
  const auto& present = std::get<PresentGoal>(rest.goals[0]);
  EXPECT_EQ(present.instead_of, 42) << "any other process will do";
  EXPECT_EQ(std::get<LifecycleGoal>(rest.goals[1]).target, Lifecycle::kActive);
}

TEST(Resumption, GoesOnWithALifecycleWhereItWas) {
  Left left;
  const Resumption rest = resumption_of(left.tuned(), left.knowledge);
  EXPECT_EQ(rest.adaptation, 1u);
  ASSERT_EQ(rest.goals.size(), 1u) << "no process is touched";
  EXPECT_EQ(std::get<LifecycleGoal>(rest.goals[0]).target, Lifecycle::kInactive);
}

TEST(Resumption, EndsTheOldProcessFirstIfItWasOnlyToldTo) {
  Left left;
  const Interrupted stopping{
      left.again,
      0,
      false,
      {left.request(left.again, 0, StopProcess{42}, Lifecycle::kActive, std::nullopt)}};
  const Resumption rest = resumption_of(stopping, left.knowledge);
  ASSERT_EQ(rest.goals.size(), 3u);
  EXPECT_EQ(std::get<GoneGoal>(rest.goals[0]).pid, 42);
}

}  // namespace
}  // namespace culprit::execute
