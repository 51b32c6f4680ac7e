#include "study/paper_claims.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "study/published.h"
#include "study/tables/claims_tables.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

const Claim& named(const std::vector<Claim>& claims, std::string_view text) {
  return *std::find_if(claims.begin(), claims.end(),
                       [&](const Claim& claim) { return claim.text == text; });
}

// Drawn around the paper's means, all that its means say must be found again.
TEST(PaperClaims, HoldForDataAsThePaperPrintsIt) {
  const Findings findings = synthetic_findings(800);
  const std::vector<Ablation> compared = ablations(findings.campaign);
  const std::vector<Claim> claims = paper_claims(findings, compared.front());
  for (const char* text :
       {"means of resolved / executed", "means of downtime [s]", "D and C: highest ratio",
        "D, C and S: next highest ratio", "D raises the ratio where C is on",
        "C delays reactions where only D is on", "S spares redeployments everywhere",
        "S lowers the ratio of D and C", "S shortens reactions where C is on",
        "means with P off by 20 %", "P off by 20 % changes nothing"})
    EXPECT_EQ(named(claims, text).verdict, Verdict::kHolds) << text;
  EXPECT_EQ(
      std::count_if(claims.begin(), claims.end(),
                    [](const Claim& claim) { return claim.verdict == Verdict::kContradicted; }),
      0);
}

// The learner selects the outcomes that it learns from: a rate that is right of these may be wrong of
// all executions.
TEST(PaperClaims, JudgeWhatIsLearnedOnAllExecutionsToo) {
  Findings findings = synthetic_findings(20);
  for (LearningCurve& curve : findings.learning) {
    curve.learned.back() = Moments::of_summary(curve.believed(), 0.01, 20);
    curve.truth = curve.believed();
    curve.truth_of_all = curve.believed() - 0.2;
  }
  const std::vector<Claim> claims = paper_claims(findings, ablations(findings.campaign).front());
  EXPECT_EQ(named(claims, "learned P of F1 and F4 reach the true rates").verdict, Verdict::kHolds);
  EXPECT_EQ(named(claims, "learned P reach the rates of all executions").verdict,
            Verdict::kContradicted);
}

// Every cell of the paper's table of effects is part of a claim: those that are coloured, and those that are not.
TEST(PaperClaims, CoverEachCellOfTheTableOfEffects) {
  const Findings findings = synthetic_findings(20);
  const std::vector<Claim> claims = paper_claims(findings, ablations(findings.campaign).front());
  std::size_t parts = 0;
  for (const char* text :
       {"D raises the ratio where C is on", "D spares redeployments where C or S is on",
        "C raises the ratio where D is on", "C spares redeployments where D is on",
        "C delays reactions where only D is on", "S spares redeployments everywhere",
        "S lowers the ratio of D and C", "S shortens reactions where C is on",
        "D has no other effect", "C has no other effect", "S has no other effect",
        "no switch changes the downtime"})
    parts += named(claims, text).parts.size();
  EXPECT_EQ(parts, published::effects().size() * kPublishedMetrics.size());
  EXPECT_EQ(named(claims, "D has no other effect").parts.size(), 7U);
  EXPECT_EQ(named(claims, "C has no other effect").parts.size(), 7U);
  EXPECT_EQ(named(claims, "S has no other effect").parts.size(), 5U);
}

TEST(PaperClaims, ComeWithTheOrderOfTheConfigurations) {
  const CampaignResult result = synthetic_result(800);
  const std::vector<OrderAgreement> all = order_agreement(ablations(result).front());
  ASSERT_EQ(all.size(), kPublishedMetrics.size());
  for (const OrderAgreement& each : all) {
    EXPECT_GT(each.pairs, 0);
    EXPECT_EQ(each.same, each.pairs);
    EXPECT_GT(*each.spearman_rho, 0.8);
    EXPECT_LT(*each.p, 0.05);
  }
}

TEST(PaperClaims, StandSideBySideForSeveralPlanners) {
  Findings findings = synthetic_findings(20);
  const Ablation one = ablations(findings.campaign).front();
  Ablation other = one;
  other.planner = "reference";
  const Table table = claims_table(findings, {one, other});
  EXPECT_EQ(table.columns.size(), 8u);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), 8u);
  const auto row = [&](std::string_view claim) {
    return *std::find_if(table.rows.begin(), table.rows.end(),
                         [&](const auto& cells) { return cells.front().text == claim; });
  };
  EXPECT_EQ(row("learned P reach the rates of all executions")[5].text, "–")
      << "the reference planner did not learn";
  // Every claim of the paper is in the table.
  EXPECT_EQ(row("the graph has almost no overhead")[4].text, "not tested");
  EXPECT_EQ(row("180 faults cause 257 failures")[7].text, "not tested");
}

}  // namespace
}  // namespace culprit::study
