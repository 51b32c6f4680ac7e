#include "knowledge/rule_states.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using enum syntax::Criticality;

std::string rule_on_c(const std::string& name, const std::string& level) {
  return "RULE " + name + "\nPOLICIES " + level +
         "\nTRIGGER x > 1\nSTRATEGY s 50 10\nADAPTATION c restart 1\n";
}

TEST(RuleStates, AComponentIsAsSickAsTheWorstOtherRuleThatIsSevereEnough) {
  const RuleSet rules =
      *check(Source("x.rules", rule_on_c("Own", "ERROR") + rule_on_c("Late", "WARNING") +
                                   rule_on_c("Early", "WARNING") +
                                   rule_on_c("Small", "NON_CRITICAL")))
           .rules;
  RuleStates states(rules);
  const ComponentId c(0);
  const RuleId own(0);
  const RuleId late(1);
  const RuleId early(2);
  const RuleId small(3);
  states.enter(own, RulePhase::kFailing);
  EXPECT_EQ(states.sickness(c, kNonCritical, own), std::nullopt) << "that is its own";
  states.enter(small, RulePhase::kFailing);
  EXPECT_EQ(states.sickness(c, kWarning, own), std::nullopt) << "that is too little";
  EXPECT_EQ(states.sickness(c, kNonCritical, own), small);
  states.enter(late, RulePhase::kFailing);
  EXPECT_EQ(states.sickness(c, kNonCritical, own), late) << "the worst";
  states.enter(early, RulePhase::kFailing);
  EXPECT_EQ(states.sickness(c, kNonCritical, own), early) << "of equals the first by name";
  EXPECT_EQ(states.sickness(c, kNonCritical, early), own);
}

}  // namespace
}  // namespace culprit
