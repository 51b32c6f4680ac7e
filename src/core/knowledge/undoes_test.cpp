#include "knowledge/undoes.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

// Does a strategy with the adaptation `after` undo one with `before`?
bool takes_back(const std::string& after, const std::string& before) {
  const RuleSet rules =
      *check(Source("x.rules",
                    "COMPONENT a NODE /a LAUNCH \"a\"\nCOMPONENT b NODE /b LAUNCH \"b\"\n"
                    "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\n"
                    "STRATEGY before 50 10\nADAPTATION " +
                        before + " 1\nSTRATEGY after 50 10\nADAPTATION " + after + " 1\n"))
           .rules;
  return undoes(rules.strategies[1], rules.strategies[0]);
}

TEST(Undoes, WhatAProcessWasToldIsGoneWithIt) {
  EXPECT_TRUE(takes_back("a redeploy", "a set_parameter gain 1"));
  EXPECT_FALSE(takes_back("a restart", "a set_parameter gain 1"));
  EXPECT_TRUE(takes_back("a set_parameter gain 2", "a set_parameter gain 1"));
  EXPECT_FALSE(takes_back("a set_parameter rate 2", "a set_parameter gain 1"));
}

TEST(Undoes, NothingByACall) {
  for (const char* before : {"a redeploy", "a activate", "a set_parameter gain 1"})
    EXPECT_FALSE(takes_back("a call ~/recalibrate", before)) << before;
  EXPECT_TRUE(takes_back("a deactivate", "a call ~/recalibrate"));
}

TEST(Undoes, NothingAtAnotherComponent) {
  EXPECT_FALSE(takes_back("b redeploy", "a set_parameter gain 1"));
  EXPECT_FALSE(takes_back("b set_parameter gain 2", "a set_parameter gain 1"));
  EXPECT_FALSE(takes_back("b deactivate", "a activate"));
  EXPECT_TRUE(takes_back("a deactivate", "a activate"));
}

}  // namespace
}  // namespace culprit
