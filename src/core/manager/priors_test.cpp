// Priors of a fleet that reach a manager while it runs.
#include <cmath>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "manager/manager.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit {
namespace {

struct ToldPriors : testing::Test {
  std::vector<PriorsAdopted> adopted() const {
    std::vector<PriorsAdopted> all;
    for (const Event& event : manager.events()) {
      if (const auto* told = std::get_if<PriorsAdopted>(&event.what)) all.push_back(*told);
    }
    return all;
  }
  void step(std::vector<PriorsTold::Prior> priors) {
    const std::vector<Observation> observations{
        {Time{}, PriorsTold{std::move(priors), "3 robots"}}};
    (void)manager.step(Time{}, observations);
  }
  const StrategyId s{0};
  const RuleSet rules =
      *check(Source("t",
                    "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION c "
                    "restart 1\n"))
           .rules;
  Manager manager{rules, std::make_unique<BayesPlanner>(Objective::kBalanced), {}};
};

TEST_F(ToldPriors, AreWhereBeliefsBegin) {
  manager.set_belief(s, {10, 1});  // one success of its own
  step({{s, 2, 6}});
  EXPECT_EQ(manager.knowledge().beliefs[s], (Belief{3, 6}));
  ASSERT_EQ(adopted().size(), 1u);
  EXPECT_EQ(adopted()[0].source, "3 robots");
  ASSERT_EQ(adopted()[0].priors.size(), 1u);
  EXPECT_EQ(adopted()[0].priors[0].beta, 6);
}

TEST_F(ToldPriors, ThatSayWhatIsKnownAreNoNews) {
  step({{s, 2, 6}});
  step({{s, 2, 6}});
  EXPECT_EQ(adopted().size(), 0u) << "of the last step";
}

TEST_F(ToldPriors, ThatAreNoneAreLeftOut) {
  const Belief before = manager.knowledge().beliefs[s];
  step({{s, 0, 1}, {s, 1, -1}, {s, std::nan(""), 1}, {s, 1, 1e300}, {StrategyId(7), 1, 1}});
  EXPECT_EQ(manager.knowledge().beliefs[s], before);
  EXPECT_TRUE(adopted().empty());
}

TEST_F(ToldPriors, AreWhatIsLeftWhenAPersonLetsItForget) {
  step({{s, 2, 6}});
  manager.set_belief(s, {8, 6});
  const std::vector<Observation> order{{Time{}, Order{1, "ada", "", Forget{}}}};
  (void)manager.step(Time{}, order);
  EXPECT_EQ(manager.knowledge().beliefs[s], (Belief{2, 6}));
}

}  // namespace
}  // namespace culprit
