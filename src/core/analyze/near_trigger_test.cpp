#include "analyze/near_trigger.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

struct NearTriggers : testing::Test {
  NearTriggers()
      : rules(*check(Source("test.rules", R"(
COMPONENT c NODE /c
SIGNAL entropy DIAGNOSTIC c KEY entropy
SIGNAL load    DIAGNOSTIC c KEY load
RULE Unsure
  POLICIES ERROR
  TRIGGER entropy > 0.06
    STRATEGY s 50 10
      ADAPTATION c restart 3
RULE Busy
  POLICIES ERROR
  TRIGGER !(load < 80) && entropy < 1
    STRATEGY s 50 10
      ADAPTATION c restart 3
RULE Old
  POLICIES ERROR
  TRIGGER age(/t) > 2s || entropy * 2 > load
    STRATEGY s 50 10
      ADAPTATION c restart 3
)"))
                   .rules),
        knowledge(rules) {}

  void set(const std::string& signal, double value) {
    for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
      const Input& input = rules.inputs[i];
      if (input.kind == Input::Kind::kSignal && rules[input.signal].name == signal)
        knowledge.signals.set(InputId(i), Slot::of(value));
    }
  }
  // "Busy load 76 80, ..."
  std::string near(std::size_t most = 10) const {
    std::string out;
    for (const NearTrigger& n : near_triggers(knowledge, most)) {
      const Input& input = rules[n.input];
      const bool is_signal = input.kind == Input::Kind::kSignal;
      char text[100];
      std::snprintf(text, sizeof text, "%s%s %s %g %g", out.empty() ? "" : ", ",
                    rules[n.rule].name.c_str(),
                    is_signal ? rules[input.signal].name.c_str() : "age", n.value, n.threshold);
      out += text;
    }
    return out;
  }

  RuleSet rules;
  Knowledge knowledge;
};

TEST_F(NearTriggers, AreSortedByTheirDistance) {
  set("entropy", 0.05);
  set("load", 76);
  EXPECT_EQ(near(), "Busy load 76 80, Unsure entropy 0.05 0.06");
  set("entropy", 0.059);
  EXPECT_EQ(near(1), "Unsure entropy 0.059 0.06");
}

TEST_F(NearTriggers, AreNear) {
  set("entropy", 0.02);
  EXPECT_EQ(near(), "");
}

TEST_F(NearTriggers, KnowNothingOfUnknownValues) { EXPECT_EQ(near(), ""); }

TEST_F(NearTriggers, AreNotFailures) {
  set("entropy", 0.05);
  knowledge.states.enter(RuleId(0), RulePhase::kFailing);
  EXPECT_EQ(near(), "");
}

TEST_F(NearTriggers, SkipWhatIsTrueAlready) {
  set("load", 90);
  set("entropy", 2);
  EXPECT_EQ(near(), "Busy entropy 2 1");
}

// `<=` and `>=` hold on either side of their equality: what holds is not near, but there.
TEST(NearTriggerOf, AComparisonThatHoldsIsNone) {
  const RuleSet rules =
      *check(Source("test.rules",
                    "COMPONENT c NODE /c\nSIGNAL load DIAGNOSTIC c KEY load\nRULE R\n"
                    "POLICIES ERROR\nTRIGGER load <= 80 && changed(load)\n"
                    "STRATEGY s 50 10\nADAPTATION c restart 3\n"))
           .rules;
  Knowledge knowledge(rules);
  const auto count_at = [&](double load) {
    for (std::size_t i = 0; i < rules.inputs.size(); ++i) {
      if (rules.inputs[i].kind == Input::Kind::kSignal)
        knowledge.signals.set(InputId(i), Slot::of(load));
    }
    return near_triggers(knowledge, 10).size();
  };
  EXPECT_EQ(count_at(81), 1u);
  EXPECT_EQ(count_at(80), 0u);
  EXPECT_EQ(count_at(79), 0u);
}

}  // namespace
}  // namespace culprit
