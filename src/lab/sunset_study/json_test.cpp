#include "sunset_study/json.h"

#include <gtest/gtest.h>

#include "json/json.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

TEST(StudyJson, HasTheDocumentedShape) {
  const CampaignResult result = synthetic_result(9);
  const Json document = parse_json(json({result, {}, {}}));
  EXPECT_EQ(keys(document), (std::vector<std::string>{"study", "campaign", "scenarios", "rows"}));
  EXPECT_EQ(document["study"], "sunset");
  ASSERT_EQ(document["rows"].size(), 9u);
  const Json& row = document["rows"][1];
  EXPECT_EQ(keys(row),
            (std::vector<std::string>{"dependencies", "criticality", "impact", "planner", "profile",
                                      "runs", "ratio", "reaction_s", "downtime_s",
                                      "unnecessary_redeployments", "honest"}));
  EXPECT_EQ(row["dependencies"], false);
  EXPECT_EQ(row["impact"], true);
  EXPECT_EQ(row["runs"], 9);
  EXPECT_EQ(row["ratio"]["mean"], result.rows[1][Metric::kRatio].mean());
  EXPECT_EQ(row["ratio"]["sd"], result.rows[1][Metric::kRatio].sd());
  EXPECT_EQ(keys(row["honest"]),
            (std::vector<std::string>{"downtime_s", "strategies_per_fault", "wrong_component",
                                      "unresolved", "recovery_s", "root_cause_top1",
                                      "root_cause_exact", "on_front"}));
  EXPECT_TRUE(row["honest"]["on_front"].is_boolean());
  EXPECT_EQ(document["rows"][8]["probabilities"], "misspecified");
}

TEST(StudyJson, HasNullForTheMeanOfNothing) {
  Campaign campaign;
  campaign.rows.resize(1);
  campaign.runs = 1;
  CampaignFold fold(campaign);
  fold.add({});
  const Json document = parse_json(json({fold.result(), {}, {}}));
  EXPECT_TRUE(document["rows"][0]["reaction_s"]["mean"].is_null());
}

TEST(StudyJson, SurvivesNamesThatAreNoUtf8) {
  Findings findings = synthetic_findings(1);
  findings.learning.front().strategy = "\xff\"";
  EXPECT_EQ(parse_json(json(findings))["learning"][0]["strategy"], "\xEF\xBF\xBD\"");
}

}  // namespace
}  // namespace culprit::study
