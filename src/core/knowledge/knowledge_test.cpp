#include "knowledge/knowledge.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

// Each telling is a row of the journal.
TEST(Knowledge, TellsWhatIsIntendedOnlyWhenThatIsNew) {
  const RuleSet rules = *check(Source("x.rules",
                                      "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 50 10\n"
                                      "ADAPTATION c activate 1\n"))
                             .rules;
  Knowledge knowledge(rules);
  for (const Lifecycle state : {Lifecycle::kActive, Lifecycle::kActive, Lifecycle::kInactive})
    knowledge.components.intend_lifecycle(ComponentId(0), state, Time(1s), knowledge.events);
  ASSERT_EQ(knowledge.events.size(), 2u);
  EXPECT_EQ(std::get<LifecycleIntended>(knowledge.events[0].what).state, Lifecycle::kActive);
  EXPECT_EQ(std::get<LifecycleIntended>(knowledge.events[1].what).state, Lifecycle::kInactive);
}

}  // namespace
}  // namespace culprit
