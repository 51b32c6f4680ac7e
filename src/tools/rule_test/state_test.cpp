#include "rule_test/state.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "rule_test/test_suite.h"

namespace culprit::rule_test {
namespace {

struct Look {
  RuleSet rules;
  State state;
  Watched watched;

  std::string failing() const {
    std::string names;
    for (const RuleId id : watched.failures) names += (names.empty() ? "" : " ") + rules[id].name;
    return names;
  }
  StrategyId strategy(const std::string& name) const {
    for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
      if (rules.strategies[s].name == name) return StrategyId(s);
    }
    throw std::logic_error("no such strategy");
  }
};

std::unique_ptr<Look> look(RuleSet rules, const std::string& text) {
  auto look = std::make_unique<Look>(Look{std::move(rules), {}, {}});
  const Source source("x.state", text);
  std::vector<Diagnostic> diagnostics;
  look->state = read_state(source, look->rules, diagnostics);
  for (const Diagnostic& d : diagnostics) ADD_FAILURE() << render(d, source);
  look->watched = watch(look->state, look->rules);
  return look;
}

std::unique_ptr<Look> look(const std::string& text) {
  return look(pipeline_rules(), kPipeline + text);
}

TEST(State, OfARobotThatIsWellShowsNoFailure) { EXPECT_EQ(look("")->failing(), ""); }

TEST(State, ShowsAllThatOneFaultBrings) {
  EXPECT_EQ(look("TOPIC /rgb silent\n")->failing(), "CameraDead FusionDead");
  EXPECT_EQ(look("COMPONENT camera KILLED\n")->failing(), "CameraDead FusionDead");
  EXPECT_EQ(look("COMPONENT fusion HUNG\n")->failing(), "FusionDead");
  EXPECT_EQ(look("SIGNAL blur 0.9\n")->failing(), "Blurred");
}

TEST(State, IsWhatTheManagerSeesAtItsMoment) {
  const std::string fading = "TOPIC /rgb 10Hz 8s: silent\n";
  EXPECT_EQ(look(fading + "RUN 8.2s\n")->failing(), "");
  EXPECT_EQ(look(fading + "RUN 9s\n")->failing(), "CameraDead FusionDead");
  EXPECT_EQ(look(fading)->failing(), "CameraDead FusionDead");
}

TEST(State, LastsAsLongAsTheRulesWait) {
  const char* rules = R"(
COMPONENT c NODE /c LAUNCH "c"
SIGNAL x DIAGNOSTIC c KEY x
RULE Slow
  POLICIES ERROR FOR 20s
  TRIGGER x > 1
    STRATEGY s 50 10
      ADAPTATION c restart 3
RULE Old
  POLICIES ERROR HOLD 50/60
  TRIGGER age(/t) > 90s && mean(x, 30s) > 1
    STRATEGY s 50 10
      ADAPTATION c restart 3
)";
  const auto checked = check(Source("slow.rules", rules));
  ASSERT_TRUE(checked.rules);
  EXPECT_EQ(look(*checked.rules, "SIGNAL x 2\n")->failing(), "Slow Old");
}

TEST(State, KnowsWhatWasTriedAndLearned) {
  const auto l = look("TOPIC /rgb silent\nSTRATEGY camera_restart TRIED HELPED 3 OF 8\n");
  const StrategyId restart = l->strategy("camera_restart");
  EXPECT_TRUE(l->watched.knowledge->states.is_tried(restart));
  EXPECT_FALSE(l->watched.knowledge->states.is_tried(l->strategy("camera_redeploy")));
  EXPECT_EQ(l->watched.knowledge->beliefs[restart], (Belief{5 + 3, 5 + 5}));
}

}  // namespace
}  // namespace culprit::rule_test
