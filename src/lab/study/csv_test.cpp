#include "study/csv.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "study/paper_claims.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

TEST(StudyCsv, HasALineForEachMetricOfEachRow) {
  const CampaignResult result = synthetic_result(20);
  const auto table = lines(metrics_csv(result));
  ASSERT_EQ(table.size(), 1 + 9 * kMetricCount);
  for (const std::string& line : table)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 17) << line;
  EXPECT_TRUE(table[1].starts_with("false,false,false,paper,paper,ideal,20,ratio,20,0."))
      << table[1];
  EXPECT_TRUE(table[1].ends_with(",0,0.75,0.2,true")) << table[1];
}

TEST(StudyCsv, HasALineForEachMetricOfEachEffect) {
  const auto table = lines(effects_csv(synthetic_result(20)));
  ASSERT_EQ(table.size(), 1u + 48);
  for (const std::string& line : table)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 13) << line;
  EXPECT_TRUE(table[1].starts_with("paper,paper,ratio,---,D--,")) << table[1];
}

TEST(StudyCsv, CountsTheValuesOfEachMetric) {
  const CampaignResult result = synthetic_result(20);
  const auto table = lines(values_csv(result));
  EXPECT_EQ(table[0],
            "dependencies,criticality,impact,planner,profile,probabilities,metric,value,count");
  std::int64_t ratios = 0;
  for (const std::string& line : table) {
    if (line.starts_with("true,true,true,paper,paper,ideal,ratio,"))
      ratios += std::stoi(line.substr(line.rfind(',') + 1));
  }
  EXPECT_EQ(ratios, 20);
}

TEST(StudyCsv, QuotesWhatWouldBreakALine) {
  Campaign campaign;
  campaign.rows.resize(1);
  campaign.rows[0].planner = "a,\"b\"\nc";
  campaign.runs = 1;
  CampaignFold fold(campaign);
  fold.add({});
  EXPECT_NE(metrics_csv(fold.result()).find("true,\"a,\"\"b\"\"\nc\",paper"), std::string::npos);
}

TEST(StudyCsv, HasALineForEachPartOfEachClaim) {
  const Findings findings = synthetic_findings(20);
  const auto table = lines(claims_csv(findings));
  std::size_t parts = 0;
  for (const Claim& claim : paper_claims(findings, ablations(findings.campaign).front()))
    parts += claim.parts.size();
  ASSERT_EQ(table.size(), 1 + parts);
  EXPECT_TRUE(table[1].starts_with("paper,paper,means of resolved / executed,TOST,alike,–––,"))
      << table[1];
  for (const std::string& line : table) EXPECT_GE(std::count(line.begin(), line.end(), ','), 19);
}

}  // namespace
}  // namespace culprit::study
