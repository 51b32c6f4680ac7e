#include "study/claim.h"

#include <gtest/gtest.h>

#include "study/statistics/holm.h"
#include "study/statistics/welch.h"

namespace culprit::study {
namespace {

Group group(double mean, double sd, std::int64_t count) {
  return {"g", Moments::of_summary(mean, sd, count)};
}

Claim judged(ClaimPart part) {
  std::vector<Claim> claims = {{"a claim", "a test", {std::move(part)}}};
  judge(claims);
  return claims.front();
}

TEST(Claims, HoldAreOpenOrAreContradicted) {
  EXPECT_EQ(judged(is_more(group(2, 1, 100), group(1, 1, 100))).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_more(group(1, 1, 100), group(2, 1, 100))).verdict, Verdict::kContradicted);
  EXPECT_EQ(judged(is_more(group(1.1, 1, 100), group(1, 1, 100))).verdict, Verdict::kOpen);
  EXPECT_EQ(judged(is_above(group(1.2, 0.3, 100), 1)).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_below(group(1.2, 0.3, 100), 1)).verdict, Verdict::kContradicted);
  EXPECT_EQ(judged(is_near(group(0.48, 0.05, 20), 0.5, 0.1)).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_near(group(0.7, 0.05, 20), 0.5, 0.1)).verdict, Verdict::kContradicted);
}

// A missing difference is no equality.
TEST(Claims, OfEqualityNeedTheDataToShowIt) {
  EXPECT_EQ(judged(is_alike(group(1, 1, 400), group(1.1, 1, 400), 0.5)).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_alike(group(1, 1, 5), group(1.1, 1, 5), 0.5)).verdict, Verdict::kOpen);
  EXPECT_EQ(judged(is_alike(group(1, 1, 400), group(2, 1, 400), 0.5)).verdict,
            Verdict::kContradicted);
}

// A difference on either side is against equality, so a margin of nearly 0 leaves Welch's two-sided test.
TEST(Claims, OfEqualityAreContradictedFromBothSides) {
  const Group a = group(1, 1, 20);
  const Group b = group(1.5, 1, 20);
  const double two_sided = welch_test(a.values, b.values)->p;
  EXPECT_NEAR(is_alike(a, b, 1e-9).p_against, two_sided, 1e-6);
  EXPECT_NEAR(is_alike(b, a, 1e-9).p_against, two_sided, 1e-6);
}

TEST(Claims, HoldOnlyIfEachPartHolds) {
  const ClaimPart strong = is_more(group(2, 1, 100), group(1, 1, 100));
  const ClaimPart weak = is_more(group(1.1, 1, 100), group(1, 1, 100));
  std::vector<Claim> claims = {{"both", "", {strong, strong}}, {"one", "", {weak, strong}}};
  judge(claims);
  EXPECT_EQ(claims[0].verdict, Verdict::kHolds);
  EXPECT_EQ(claims[1].verdict, Verdict::kOpen);
  EXPECT_EQ(claims[1].supported(), 1u);
  EXPECT_EQ(claims[1].decisive().shown, weak.shown);
}

// Welch's test knows no samples without any spread, but a claim on them has an answer.
TEST(Claims, OfSamplesWithoutSpreadGoByTheMeans) {
  EXPECT_EQ(judged(is_more(group(1, 0, 10), group(0, 0, 10))).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_more(group(0, 0, 10), group(0, 0, 10))).verdict, Verdict::kOpen);
  EXPECT_EQ(judged(is_alike(group(0, 0, 10), group(0, 0, 10), 0.1)).verdict, Verdict::kHolds);
  EXPECT_EQ(judged(is_above(group(2, 0, 1), 1)).verdict, Verdict::kOpen) << "one value";
}

// Hedges' g of t = (1 - 0) / sqrt(2 / 10) with 18 degrees: d = 1, J = 1 - 3 / 71.
TEST(Claims, HaveHedgesEffectSize) {
  EXPECT_NEAR(hedges_g(Moments::of_summary(0, 1, 10), Moments::of_summary(1, 1, 10)), 1 - 3.0 / 71,
              1e-12);
}

// p.adjust(c(0.01, 0.04, 0.03, 0.5), "holm")
TEST(Claims, AreCorrectedAsByR) {
  const std::vector<double> p = {0.01, 0.04, 0.03, 0.5};
  const std::vector<double> expected = {0.04, 0.09, 0.09, 0.5};
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(adjusted[i], expected[i], 1e-12);
}

}  // namespace
}  // namespace culprit::study
