#include "robot/component_binding.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

RuleSet wheels(const std::string& clause) {
  const Source source("test.rules", "COMPONENT wheel" + clause +
                                        " LAUNCH \"wheel\"\nRULE r\n  POLICIES ERROR\n"
                                        "  TRIGGER !alive(wheel)\n    STRATEGY s 50 10\n"
                                        "      ADAPTATION wheel redeploy 10\n");
  return *check(source).rules;
}

TEST(ComponentBinding, IsTheFirstNodeOfTheName) {
  const RuleSet rules = wheels("");
  ComponentBinding binding(rules);
  EXPECT_FALSE(binding.bind("/left/door"));
  EXPECT_EQ(binding.bind("/left/wheel"), ComponentId(0));
  EXPECT_EQ(binding.bind("/left/wheel"), ComponentId(0));
  EXPECT_EQ(binding.node_of(ComponentId(0)), "/left/wheel");
  EXPECT_EQ(binding.ambiguity(ComponentId(0)), "");
}

TEST(ComponentBinding, IsInDoubtOnceASecondNodeFits) {
  const RuleSet rules = wheels("");
  ComponentBinding binding(rules);
  binding.bind("/left/wheel");
  EXPECT_FALSE(binding.bind("/right/wheel"));
  EXPECT_EQ(binding.ambiguity(ComponentId(0)),
            "it could be /left/wheel or /right/wheel: say which with NODE /left/wheel");
}

TEST(ComponentBinding, IsNeverInDoubtWithANode) {
  const RuleSet rules = wheels(" NODE /left/wheel");
  ComponentBinding binding(rules);
  binding.bind("/left/wheel");
  EXPECT_FALSE(binding.bind("/right/wheel"));
  EXPECT_EQ(binding.ambiguity(ComponentId(0)), "");
}

}  // namespace
}  // namespace culprit
