#include "plan/what_if.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/validity.h"

namespace culprit::plan {
namespace {

struct WhatIfTest : testing::Test {
  WhatIfTest()
      : rules(*check(Source("test.rules", R"(
COMPONENT lamp NODE /lamp LAUNCH "lamp"
RULE Dark
  POLICIES ERROR
  TRIGGER x > 1
    STRATEGY light 50 10 WHEN lifecycle(lamp) != "active"
      ADAPTATION lamp activate 3
)"))
                   .rules),
        knowledge(rules) {
    knowledge.components[lamp].alive = true;
    knowledge.components[lamp].lifecycle = Lifecycle::kActive;
    knowledge.signals.set(lifecycle_input(), Slot::of(std::string_view("active")));
  }

  InputId lifecycle_input() const {
    for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
      if (rules.inputs[i].kind == Input::Kind::kLifecycle) return InputId(i);
    }
    throw std::logic_error("no such input");
  }
  std::string_view lifecycle(const Knowledge& of) const { return of.signals[lifecycle_input()].s; }

  RuleSet rules;
  Knowledge knowledge;
  const ComponentId lamp{0};
  const StrategyId light{0};
};

TEST_F(WhatIfTest, IsACopyOfItsOwn) {
  const WhatIf what_if(knowledge);
  knowledge.signals.set(lifecycle_input(), Slot::of(std::string_view("unconfigured")));
  EXPECT_EQ(lifecycle(what_if.knowledge()), "active");
  EXPECT_NE(&what_if.knowledge().rules, &rules);
}

TEST_F(WhatIfTest, AChangedComponentShowsInConditionsToo) {
  WhatIf what_if(knowledge);
  const auto is_valid = [&] {
    return !invalidity(what_if.knowledge().rules[light], what_if.knowledge());
  };
  EXPECT_FALSE(is_valid());
  what_if.assume(ComponentChange{lamp, ComponentChange::Situation::kInactive});
  EXPECT_TRUE(is_valid());
  EXPECT_EQ(lifecycle(what_if.knowledge()), "inactive");
  EXPECT_EQ(lifecycle(knowledge), "active");
  what_if.undo();
  EXPECT_FALSE(is_valid());
  EXPECT_EQ(lifecycle(what_if.knowledge()), "active");
}

TEST_F(WhatIfTest, UndoesAllThatWasAssumedLastFirst) {
  WhatIf what_if(knowledge);
  what_if.assume(SuccessChange{light, percent(90)});
  what_if.assume(SuccessChange{light, percent(10)});
  what_if.assume(ImpactChange{light, {7}});
  what_if.assume(TriedChange{light});
  EXPECT_DOUBLE_EQ(what_if.knowledge().beliefs[light].mean().value, 0.1);
  EXPECT_EQ(what_if.knowledge().rules.heaviest, Cycles{7});
  EXPECT_TRUE(what_if.knowledge().states.is_tried(light));
  what_if.undo();
  EXPECT_EQ(what_if.knowledge().beliefs[light], knowledge.beliefs[light]);
  EXPECT_EQ(what_if.knowledge().rules.heaviest, Cycles{3});
  EXPECT_FALSE(what_if.knowledge().states.is_tried(light));
}

}  // namespace
}  // namespace culprit::plan
