#include "knowledge/coincidences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class CoincidencesOfThree : public ::testing::Test {
 protected:
  // b begins while a is new.
  void begin_together(RuleId a, RuleId b) {
    coincidences_.began(a, {});
    coincidences_.began(b, std::vector<RuleId>{a});
  }

  const RuleId a_{0}, b_{1}, c_{2};
  Coincidences coincidences_{of_three_rules()};

 private:
  static RuleSet of_three_rules() {
    RuleSet rules;
    rules.rules.resize(3);
    return rules;
  }
};

TEST_F(CoincidencesOfThree, OnceMayBeChance) {
  begin_together(a_, b_);
  EXPECT_FALSE(coincidences_.coincide(a_, b_));
  begin_together(a_, b_);
  EXPECT_TRUE(coincidences_.coincide(a_, b_));
  EXPECT_TRUE(coincidences_.coincide(b_, a_));
  EXPECT_THAT(coincidences_.of(a_), ElementsAre(b_));
  EXPECT_THAT(coincidences_.of(c_), IsEmpty());
}

// Two of ten failures each began together: that is no common cause.
TEST_F(CoincidencesOfThree, RareCoincidencesMeanNothing) {
  for (int k = 0; k < 8; ++k) {
    coincidences_.began(a_, {});
    coincidences_.began(b_, {});
  }
  begin_together(a_, b_);
  begin_together(a_, b_);
  EXPECT_FALSE(coincidences_.coincide(a_, b_));
}

TEST_F(CoincidencesOfThree, AStormOfFailuresMakesNoPairs) {
  const std::vector<RuleId> many(Coincidences::kMostTogether + 1, b_);
  coincidences_.began(a_, many);
  coincidences_.began(a_, many);
  EXPECT_EQ(coincidences_.together(a_, b_), 0);
}

TEST_F(CoincidencesOfThree, CountsOfAnEarlierRunGoOn) {
  coincidences_.set(b_, a_, 1);
  coincidences_.set(a_, a_, 1);
  coincidences_.set(b_, b_, Coincidences::kMost);
  EXPECT_FALSE(coincidences_.coincide(a_, b_));
  begin_together(a_, b_);
  EXPECT_EQ(coincidences_.together(a_, b_), 2);
  EXPECT_EQ(coincidences_.times(a_), 2);
  EXPECT_EQ(coincidences_.times(b_), Coincidences::kMost);
  EXPECT_TRUE(coincidences_.coincide(a_, b_));
}

// A reader that follows the counts looks at that rule and its partners alone.
TEST_F(CoincidencesOfThree, ARuleChangesWhenItBegins) {
  begin_together(a_, b_);
  begin_together(b_, c_);
  EXPECT_THAT(coincidences_.partners(b_), ElementsAre(a_, c_));
  const auto changes = [&] {
    return std::vector{coincidences_.changes(a_), coincidences_.changes(b_),
                       coincidences_.changes(c_)};
  };
  const auto before = changes();
  coincidences_.began(c_, std::vector<RuleId>{a_});
  EXPECT_THAT(changes(), ElementsAre(before[0], before[1], before[2] + 1));
  EXPECT_THAT(coincidences_.partners(a_), ElementsAre(b_, c_));
  EXPECT_EQ(coincidences_.together(a_, c_), 1);
}

TEST_F(CoincidencesOfThree, OnlyTheCountsOfOneRuleAreForgotten) {
  for (int k = 0; k < 2; ++k) begin_together(a_, b_);
  for (int k = 0; k < 2; ++k) begin_together(b_, c_);
  coincidences_.forget(a_);
  EXPECT_EQ(coincidences_.times(a_), 0);
  EXPECT_EQ(coincidences_.together(a_, b_), 0);
  EXPECT_EQ(coincidences_.times(b_), 4);
  EXPECT_THAT(coincidences_.of(b_), ElementsAre(c_));
}

}  // namespace
}  // namespace culprit
