#include "study/published.h"

#include <gtest/gtest.h>

namespace culprit::study::published {
namespace {

double mean(const PaperSwitches& switches, std::size_t metric) {
  return (*values_of({switches, "paper", "paper", Probabilities::kIdeal}))[metric].mean;
}

// The paper's two ablation tables have the same content, so a typing error in one does not pass.
TEST(Published, ChangesInPercentFollowFromTheMeans) {
  for (const Effect& effect : effects()) {
    for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
      const double without = mean(effect.without, i);
      const double with = mean(effect.with, i);
      EXPECT_NEAR(effect.changes[i].percent, (with - without) / without * 100, 0.00501)
          << label(effect.without) << " -> " << label(effect.with) << ", "
          << traits(kPublishedMetrics[i]).key;
    }
  }
}

TEST(Published, VerdictsFollowFromTheSignsAndFromWhatIsBetter) {
  int significant = 0;
  for (const Effect& effect : effects()) {
    for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
      const Change& change = effect.changes[i];
      if (change.significance == Significance::kNotSignificant) continue;
      ++significant;
      const bool rises = change.percent > 0;
      const bool is_better = rises == (traits(kPublishedMetrics[i]).better == Better::kHigher);
      EXPECT_EQ(change.significance, is_better ? Significance::kBetter : Significance::kWorse);
    }
  }
  EXPECT_EQ(significant, 17) << "coloured cells of the table";
}

TEST(Published, EachEffectSwitchesOneFactorOn) {
  for (const Effect& effect : effects()) {
    PaperSwitches expected = effect.without;
    (effect.factor == Factor::kDependencies  ? expected.dependencies
     : effect.factor == Factor::kCriticality ? expected.criticality
                                             : expected.impact) = true;
    EXPECT_NE(effect.without, effect.with);
    EXPECT_EQ(expected, effect.with);
  }
}

TEST(Published, RobustnessBeginsWithTheBestOfTheAblation) {
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    EXPECT_EQ(robustness()[0].values[i].mean, ablation()[7].values[i].mean);
    EXPECT_EQ(robustness()[0].values[i].sd, ablation()[7].values[i].sd);
  }
}

TEST(Published, HasNothingOfWhatThePaperDidNotPlay) {
  EXPECT_FALSE(values_of({{false, true, true}, "paper", "paper", Probabilities::kMisspecified}));
}

}  // namespace
}  // namespace culprit::study::published
