#include "suave_study/suave_claims.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "suave_study/fit.h"
#include "suave_study/published.h"

namespace culprit::study {
namespace {

// A result with the paper's own figures.
SuaveResult as_published(const char* mission) {
  SuaveResult result;
  result.campaign.plan = *suave::model::find_mission_plan(mission);
  for (const char* manager : {"none", "bt", "metacontrol", "rosa", kCulprit}) {
    SuaveRow row;
    row.manager = manager;
    row.runs = published::kSuaveRuns;
    row.outliers = std::string(mission) == "standard" ? 9 : 7;
    if (const auto* paper = published::find_suave(mission, manager)) {
      row.search_s = paper->search_s;
      row.distance_m = paper->distance_m;
      const auto reactions = [](std::optional<double> mean) {
        return Moments::of_summary(mean.value_or(0), 0.02, 100);
      };
      row.visibility.answered_s = reactions(paper->visibility_s);
      row.thruster.answered_s = reactions(paper->thruster_s);
      row.battery.answered_s = reactions(paper->battery_s);
    }
    result.rows.push_back(std::move(row));
  }
  return result;
}

// The paper's own table, judged by the same tests.
TEST(SuaveClaims, OfThePaperOnItsOwnFigures) {
  const std::vector<Claim> claims =
      suave_claims(as_published("standard"), as_published("extended"));
  const auto verdict = [&](std::string_view text) {
    return std::find_if(claims.begin(), claims.end(),
                        [&](const Claim& claim) { return claim.text == text; })
        ->verdict;
  };
  for (const char* text :
       {"Ours as printed", "reactions of BT, Metacontrol, ROSA", "reactions of Ours",
        "9 and 7 of 100 own runs are outliers", "reacts second to BT",
        "extended: inspects more than ROSA", "extended: reacts second to BT"})
    EXPECT_EQ(verdict(text), Verdict::kHolds) << text;
  // Its means are shorter by less than chance allows.
  EXPECT_EQ(verdict("Ours: shortest search"), Verdict::kOpen);
  EXPECT_EQ(verdict("inspects second to BT"), Verdict::kOpen);
}

// Managers that are alike in all of their runs: only the rule that drops long searches of culprit's
// makes a difference, and no claim may hold because of it alone.
TEST(SuaveClaims, ThatHoldOnlyByLeavingRunsOutAreOpenOnAllRuns) {
  SuaveResult standard = as_published("standard");
  SuaveResult extended = as_published("extended");
  for (SuaveResult* mission : {&standard, &extended}) {
    for (SuaveRow& row : mission->rows) {
      const bool is_ours = row.manager == kCulprit;
      row.searched_s = Moments::of_summary(93, 28, 400);
      row.last_distance_m = Moments::of_summary(61, 9, 400);
      row.search_s = is_ours ? Moments::of_summary(81, 16, 350) : row.searched_s;
      row.distance_m = is_ours ? Moments::of_summary(65, 5, 350) : row.last_distance_m;
    }
  }
  const std::vector<Claim> claims = suave_claims(standard, extended);
  const auto verdict = [&](std::string_view text) {
    return std::find_if(claims.begin(), claims.end(),
                        [&](const Claim& claim) { return claim.text == text; })
        ->verdict;
  };
  for (const char* text : {"Ours: shortest search", "extended: inspects more than ROSA",
                           "extended: searches shorter than BT, ROSA"})
    EXPECT_EQ(verdict(text), Verdict::kHolds) << text;
  EXPECT_EQ(verdict("all runs: shortest search, both missions"), Verdict::kOpen);
  EXPECT_EQ(verdict("all runs: inspects second to BT; extended: more than ROSA"), Verdict::kOpen);
}

TEST(SuaveClaims, AreATableWithARowForEach) {
  const SuaveResult standard = as_published("standard");
  const SuaveResult extended = as_published("extended");
  const Table table = suave_claims_table(standard, extended);
  EXPECT_EQ(table.rows.size(), suave_claims(standard, extended).size());
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
}

TEST(PublishedTargets, AreTheRowsThatAreAskedForButNeverCulprits) {
  const auto all = published_targets();
  ASSERT_TRUE(all) << all.error();
  EXPECT_EQ((*all)[0].targets.size() + (*all)[1].targets.size(), 6u);
  const auto some = published_targets({"none", "extended:bt"});
  ASSERT_TRUE(some) << some.error();
  ASSERT_EQ((*some)[0].targets.size(), 1u);
  EXPECT_EQ((*some)[0].targets[0].manager, "none");
  ASSERT_EQ((*some)[1].targets.size(), 1u);
  EXPECT_FALSE(published_targets({"culprit"}));
  EXPECT_FALSE(published_targets({"random"}));
}

}  // namespace
}  // namespace culprit::study
