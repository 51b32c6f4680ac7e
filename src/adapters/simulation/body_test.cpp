#include "simulation/body.h"

#include <gtest/gtest.h>

namespace culprit::simulation {
namespace {

TEST(Body, MakesTheTransitionsThatItsStateAllows) {
  Body body;
  EXPECT_FALSE(body.change(Transition::kActivate)) << "it is active";
  EXPECT_TRUE(body.change(Transition::kDeactivate));
  EXPECT_EQ(body.state, Lifecycle::kInactive);
  EXPECT_TRUE(body.change(Transition::kCleanup));
  EXPECT_EQ(body.state, Lifecycle::kUnconfigured);
  EXPECT_EQ(body.answer(ChangeLifecycle{Transition::kActivate}).outcome, Outcome::kRefused);
  body.state = Lifecycle::kUnknown;
  EXPECT_FALSE(body.change(Transition::kConfigure)) << "it has no lifecycle";
}

TEST(Body, TakesValuesOfTheTypeThatAParameterHas) {
  Body body;
  body.parameters["gain"] = 0.5;
  EXPECT_EQ(body.answer(SetParameter{"gain", Value(0.7)}).outcome, Outcome::kDone);
  EXPECT_EQ(body.answer(SetParameter{"gain", Value(true)}).outcome, Outcome::kRefused);
  EXPECT_EQ(body.answer(SetParameter{"gone", Value(true)}).outcome, Outcome::kRefused);
  EXPECT_EQ(std::get<Value>(body.answer(ReadParameter{"gain"}).value), Value(0.7));
  EXPECT_EQ(body.answer(ReadParameter{"gone"}).text, "no parameter gone");
}

TEST(Body, IsHeardAgainWhenItsNewProcessHasANode) {
  Body body;
  body.answers = false;
  EXPECT_FALSE(body.can_answer()) << "it hangs";
  EXPECT_TRUE(body.end());
  EXPECT_FALSE(body.end()) << "it is gone";
  body.start(7);
  EXPECT_FALSE(body.can_answer());
  body.is_in_graph = true;
  EXPECT_TRUE(body.can_answer());
}

}  // namespace
}  // namespace culprit::simulation
