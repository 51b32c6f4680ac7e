// Who can have the same effect as a strategy?
#include "knowledge/ambiguity.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

// camera -> fusion, and a lamp beside them.
struct Three {
  RuleSet rules = *check(Source("three.rules",
                                "COMPONENT camera NODE /camera\nCOMPONENT fusion NODE /fusion\n"
                                "COMPONENT lamp NODE /lamp\nDEPENDENCY fusion ON camera\n"
                                "RULE Bad\nPOLICIES ERROR\nTRIGGER quality < 0.5\n"
                                "STRATEGY tune 50 10\nADAPTATION fusion restart 1\n"))
                       .rules;
  Knowledge knowledge{rules};
};

TEST(Ambiguity, OneOfSeveralAdaptedComponentsIsEnough) {
  const Three three;
  const ComponentId camera(0);
  const ComponentId fusion(1);
  const ComponentId lamp(2);
  EXPECT_TRUE(can_resolve(three.knowledge, {fusion}, RuleId(0)));
  EXPECT_TRUE(can_resolve(three.knowledge, {camera}, RuleId(0))) << "fusion needs it";
  EXPECT_FALSE(can_resolve(three.knowledge, {lamp}, RuleId(0)));
  EXPECT_TRUE(can_resolve(three.knowledge, {camera, lamp}, RuleId(0)));
}

TEST(Ambiguity, WhatCanResolveAFailureHasItAmongItsEffects) {
  const Three three;
  for (const std::vector<ComponentId>& adapted : {std::vector{ComponentId(0)},
                                                  {ComponentId(1)},
                                                  {ComponentId(2)},
                                                  {ComponentId(0), ComponentId(2)}})
    EXPECT_EQ(Effects(three.knowledge, adapted).reach(three.rules.rules[0]),
              can_resolve(three.knowledge, adapted, RuleId(0)));
}

TEST(Ambiguity, BeginsAnewIsWhatEndsOrStartsWhatRuns) {
  const RuleSet rules =
      *check(Source("anew.rules",
                    "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
                    "RULE Bad\nPOLICIES ERROR\nTRIGGER quality < 0.5\n"
                    "STRATEGY set 50 10\nADAPTATION camera set_parameter gain 1 1\n"
                    "STRATEGY activate 50 10\nADAPTATION camera activate 1\n"
                    "STRATEGY restart 50 10\nADAPTATION camera restart 1\n"
                    "STRATEGY redeploy 50 10\nADAPTATION camera redeploy 5\n"
                    "STRATEGY start 50 10\nADAPTATION camera start 5\n"
                    "STRATEGY stop 50 10\nADAPTATION camera stop 5\n"))
           .rules;
  for (const Strategy& strategy : rules.strategies)
    EXPECT_EQ(begins_anew(strategy), strategy.name != "set" && strategy.name != "activate")
        << strategy.name;
}

// The lamp has nothing to do with it, the camera has.
TEST(Ambiguity, OneUpstreamIsEnoughToBringAFailureBack) {
  const RuleSet rules =
      *check(
           Source("back.rules",
                  "COMPONENT camera NODE /camera\nCOMPONENT fusion NODE /fusion\n"
                  "COMPONENT lamp NODE /lamp\nDEPENDENCY fusion ON camera\n"
                  "RULE Bad\nPOLICIES ERROR\nTRIGGER quality < 0.5\n"
                  "STRATEGY tune 50 10\nADAPTATION fusion restart 1\n"
                  "RULE Dark\nPOLICIES ERROR\nTRIGGER light < 0.5\n"
                  "STRATEGY light 50 10\nADAPTATION lamp restart 1\n"
                  "RULE Both\nPOLICIES ERROR\nTRIGGER view < 0.5\n"
                  "STRATEGY both 50 10\nADAPTATION lamp restart 1\nADAPTATION camera restart 1\n"))
           .rules;
  const Knowledge knowledge(rules);
  EXPECT_FALSE(may_bring_back(knowledge, RuleId(1), RuleId(0)));
  EXPECT_TRUE(may_bring_back(knowledge, RuleId(2), RuleId(0)));
  EXPECT_FALSE(may_bring_back(knowledge, RuleId(0), RuleId(2))) << "it is downstream";
}

}  // namespace
}  // namespace culprit
