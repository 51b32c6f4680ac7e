#include "exemplars/sunset/sunset_scenario.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::sunset {
namespace {

TEST(Scenarios, AreNumberedAsTheExemplars) {
  EXPECT_EQ(find_scenario("001")->name(), "image_degradation+camera_driver_issue");
  EXPECT_EQ(find_scenario("006")->name(), "image_degradation+gpu_failure");
  EXPECT_EQ(find_scenario("010")->name(), "depth_degradation+hardware_disconnect");
  EXPECT_EQ(find_scenario("014")->name(), "image_shift+sync_issue");
  EXPECT_EQ(find_scenario("018")->name(), "image_shift+gpu_failure");
}

TEST(Scenarios, CombineOneWarningOneFailureAndTheAutofocus) {
  std::set<std::string> names;
  for (const Scenario& scenario : scenarios()) {
    EXPECT_EQ(scenario.faults[0]->criticality, Criticality::kError);
    EXPECT_EQ(scenario.faults[1]->criticality, Criticality::kWarning);
    EXPECT_EQ(scenario.faults[2]->name, "autofocus_needed");
    EXPECT_EQ(find_scenario(scenario.name())->number, scenario.number);
    EXPECT_EQ(find_scenario(scenario.label())->number, scenario.number);
    names.insert(scenario.name());
  }
  EXPECT_EQ(names.size(), 18U);
}

TEST(Scenarios, AreNotFoundByOtherNames) {
  for (const char* name : {"", "000", "019", "1", "sync_issue"}) {
    const auto found = find_scenario(name);
    ASSERT_FALSE(found) << name;
    EXPECT_NE(found.error().find("001 to 018"), std::string::npos);
  }
}

TEST(Faults, AreTen) {
  EXPECT_EQ(faults().size(), 10U);
  EXPECT_EQ(find_fault("image_shift")->value, Value(std::int64_t{300}));
  EXPECT_EQ(find_fault("nonsense"), nullptr);
  for (const Fault& fault : faults()) EXPECT_EQ(fault.value.index(), fault.healthy.index());
}

// The rules know the robot by the names that the robot has.
TEST(Faults, AreResolvedByStrategiesOfTheRules) {
  const auto source = Source::read("rules/sunset.rules");
  ASSERT_TRUE(source) << source.error();
  const auto checked = check(*source);
  ASSERT_TRUE(checked.rules);
  const RuleSet& rules = *checked.rules;
  for (const Fault& fault : faults()) {
    for (const std::string_view name : fault.resolved_by) {
      const auto strategy = std::ranges::find(rules.strategies, name, &Strategy::name);
      ASSERT_NE(strategy, rules.strategies.end()) << name;
      EXPECT_EQ(rules[strategy->rule].policies.criticality, fault.criticality) << name;
      const bool adapts_it = std::ranges::any_of(strategy->components, [&](ComponentId component) {
        return rules[component].node == node_of(fault.member).full();
      });
      EXPECT_TRUE(adapts_it || name == "enhancement_activate") << name;
    }
  }
}

TEST(Members, AreTheComponentsOfTheRules) {
  const auto source = Source::read("rules/sunset.rules");
  ASSERT_TRUE(source) << source.error();
  const auto checked = check(*source);
  ASSERT_TRUE(checked.rules);
  std::set<std::string> components;
  for (const Component& component : checked.rules->components) {
    components.insert(component.node + " " + component.launch.at(1));
  }
  std::set<std::string> members;
  for (const Member member : kManagedMembers) {
    members.insert(node_of(member).full() + " " + std::string(name_of(member)));
  }
  EXPECT_EQ(components, members);
}

}  // namespace
}  // namespace culprit::sunset
