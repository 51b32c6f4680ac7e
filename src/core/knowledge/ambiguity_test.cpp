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

}  // namespace
}  // namespace culprit
