#include "ros2/lifecycle.h"

#include <set>

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using enum LifecycleState;

// Asks for the transition with this label and finishes it.
bool go(LifecycleMachine& machine, std::string_view label,
        TransitionResult result = TransitionResult::kSuccess) {
  const LifecycleTransition* transition = machine.find(label);
  if (transition == nullptr) return false;
  machine.begin(*transition);
  machine.finish(result);
  return true;
}

TEST(Lifecycle, GoesRound) {
  LifecycleMachine machine;
  EXPECT_EQ(machine.state(), kUnconfigured);
  EXPECT_TRUE(go(machine, "configure"));
  EXPECT_EQ(machine.state(), kInactive);
  EXPECT_TRUE(go(machine, "activate"));
  EXPECT_EQ(machine.state(), kActive);
  EXPECT_TRUE(go(machine, "deactivate"));
  EXPECT_EQ(machine.state(), kInactive);
  EXPECT_TRUE(go(machine, "cleanup"));
  EXPECT_EQ(machine.state(), kUnconfigured);
  EXPECT_TRUE(go(machine, "shutdown"));
  EXPECT_EQ(machine.state(), kFinalized);
  EXPECT_FALSE(go(machine, "configure"));
}

TEST(Lifecycle, TakesTwoSteps) {
  LifecycleMachine machine;
  const LifecycleTransition begun = machine.begin(*machine.find("configure"));
  EXPECT_EQ(machine.state(), kConfiguring);
  EXPECT_EQ(begun.goal, kConfiguring);
  const LifecycleTransition finished = machine.finish(TransitionResult::kSuccess);
  EXPECT_EQ(finished.start, kConfiguring);
  EXPECT_EQ(finished.goal, kInactive);
}

TEST(Lifecycle, FailureReturns) {
  LifecycleMachine machine;
  EXPECT_TRUE(go(machine, "configure", TransitionResult::kFailure));
  EXPECT_EQ(machine.state(), kUnconfigured);
}

TEST(Lifecycle, AnErrorIsProcessed) {
  LifecycleMachine machine;
  EXPECT_TRUE(go(machine, "configure", TransitionResult::kError));
  EXPECT_EQ(machine.state(), kErrorProcessing);
  machine.finish(TransitionResult::kSuccess);
  EXPECT_EQ(machine.state(), kUnconfigured);
  EXPECT_TRUE(go(machine, "configure", TransitionResult::kError));
  machine.finish(TransitionResult::kFailure);
  EXPECT_EQ(machine.state(), kFinalized);
}

TEST(Lifecycle, OffersOnlyWhatStartsHere) {
  const LifecycleMachine machine;
  EXPECT_NE(machine.find(1), nullptr);
  EXPECT_NE(machine.find(5), nullptr);
  for (const std::uint8_t other : {0, 2, 3, 4, 6, 7, 8, 10, 60, 255})
    EXPECT_EQ(machine.find(other), nullptr);
  EXPECT_EQ(machine.find("activate"), nullptr);
  EXPECT_EQ(machine.find(""), nullptr);
}

TEST(Lifecycle, ShutsDownFromEachPrimaryStateByItsOwnId) {
  LifecycleMachine machine;
  EXPECT_EQ(machine.find("shutdown")->id, 5);
  go(machine, "configure");
  EXPECT_EQ(machine.find("shutdown")->id, 6);
  go(machine, "activate");
  EXPECT_EQ(machine.find("shutdown")->id, 7);
}

TEST(Lifecycle, EveryTransitionStateHasItsThreeResults) {
  for (const LifecycleState state :
       {kConfiguring, kCleaningUp, kActivating, kDeactivating, kShuttingDown, kErrorProcessing}) {
    std::set<std::string_view> results;
    for (const LifecycleTransition& transition : lifecycle_transitions()) {
      if (transition.start == state) results.insert(transition.label);
    }
    EXPECT_EQ(results, (std::set<std::string_view>{"transition_success", "transition_failure",
                                                   "transition_error"}));
  }
}

TEST(Lifecycle, IdsAreUnique) {
  std::set<std::uint8_t> ids;
  for (const LifecycleTransition& transition : lifecycle_transitions())
    EXPECT_TRUE(ids.insert(transition.id).second);
  EXPECT_EQ(ids.size(), 25u);
  EXPECT_EQ(lifecycle_states().size(), 11u);
}

TEST(Lifecycle, StatesHaveTheLabelsOfRcl) {
  EXPECT_EQ(to_message(kActive), (msg::State{3, "active"}));
  EXPECT_EQ(to_message(kCleaningUp), (msg::State{11, "cleaningup"}));
  EXPECT_EQ(to_message(kErrorProcessing), (msg::State{15, "errorprocessing"}));
}

}  // namespace
}  // namespace culprit::ros2
