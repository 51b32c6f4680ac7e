// Which requests need no disk before they go out.
#include "journal/settled_here.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::journal {
namespace {

constexpr const char* kAllKinds = R"(
COMPONENT arm NODE /arm LAUNCH "arm"
COMPONENT base NODE /base UNIT base.service HOST robot@base
RULE Odd
  POLICIES ERROR
  TRIGGER age(/joints) > 1s
    STRATEGY set_parameter 50 10
      ADAPTATION arm set_parameter gain 0.5 1
    STRATEGY increase_parameter 50 10
      ADAPTATION arm increase_parameter gain 0.5 1
    STRATEGY decrease_parameter 50 10
      ADAPTATION arm decrease_parameter gain 0.5 1
    STRATEGY change_communication 50 10
      ADAPTATION arm change_communication input /other 1
    STRATEGY activate 50 10
      ADAPTATION arm activate 1
    STRATEGY deactivate 50 10
      ADAPTATION arm deactivate 1
    STRATEGY restart 50 10
      ADAPTATION arm restart 1
    STRATEGY redeploy 50 10
      ADAPTATION arm redeploy 1
    STRATEGY start 50 10
      ADAPTATION arm start 1
    STRATEGY stop 50 10
      ADAPTATION arm stop 1
    STRATEGY change_mode 50 10
      ADAPTATION arm change_mode SLOW 1
    STRATEGY call 50 10
      ADAPTATION arm call reset 1
    STRATEGY elsewhere 50 10
      ADAPTATION base redeploy 1
)";

struct SettledHere : testing::Test {
  bool is_settled(const std::string& strategy) const {
    for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
      if (rules.strategies[s].name != strategy) continue;
      Command command;
      command.component = rules.strategies[s].adaptations[0].component;
      command.purpose.strategy = StrategyId(s);
      return is_settled_here(command, knowledge);
    }
    ADD_FAILURE() << strategy;
    return false;
  }

  const RuleSet rules = *check(Source("test", kAllKinds)).rules;
  Knowledge knowledge{rules};
};

TEST_F(SettledHere, IsWhatCanBeReadBackOfAProcessOnThisMachine) {
  knowledge.components[ComponentId(0)].node_pid = 100;
  for (const char* strategy : {"set_parameter", "change_communication", "activate", "deactivate",
                               "restart", "redeploy", "start", "stop", "change_mode"})
    EXPECT_TRUE(is_settled(strategy)) << strategy;
}

TEST_F(SettledHere, AreNeitherRoutinesNorSteps) {
  knowledge.components[ComponentId(0)].node_pid = 100;
  for (const char* strategy : {"call", "increase_parameter", "decrease_parameter"})
    EXPECT_FALSE(is_settled(strategy)) << strategy;
}

TEST_F(SettledHere, IsNothingOfWhatIsNotKnownToRunHere) {
  for (const char* strategy : {"set_parameter", "redeploy", "change_mode"})
    EXPECT_FALSE(is_settled(strategy)) << strategy;
  knowledge.components[ComponentId(1)].pid = 100;  // whatever has that number here
  EXPECT_FALSE(is_settled("elsewhere"));
}

}  // namespace
}  // namespace culprit::journal
