#include "study/tables/render.h"

#include <gtest/gtest.h>

#include "json/json.h"
#include "study/tables/columns.h"
#include "study/tables/study_tables.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

Table sample() {
  return {"sample",
          "Findings of 50 % of <all>",
          {{"", "name", "", "", Align::kLeft},
           {"ratio", "ours", "$r$", ""},
           {"ratio", "paper", "$r$", ""}},
          {{{"a_b|c"}, {"1.00 ± 0.20", Shade::kNone, 0, true}, {"✓"}},
           {{"d"}, {"−2.00", Shade::kWorse, 0.5, false}, {"3.00", Shade::kBetter, 1, false}},
           {{"e"}, {"0.00", Shade::kNotSignificant, 0, false}, {"–"}}},
          {"A note."}};
}

TEST(Tables, AreAlignedInATerminal) {
  EXPECT_EQ(text(sample()), R"(Findings of 50 % of <all>

              ratio
name          ours   paper
-----  -----------  ------
a_b|c  1.00 ± 0.20       ✓
d          −2.00 !  3.00 +
e             0.00       –

+ significantly better, ! significantly worse; without a sign not significant.

A note.
)");
}

TEST(Tables, SetTheLiveRobotBesideItsModel) {
  CampaignResult result = synthetic_result(4);
  EXPECT_TRUE(std::none_of(result.rows.begin(), result.rows.end(),
                           [](const Row& row) { return row.configuration.profile == kLiveRobot; }));
  result.rows.resize(2);
  result.rows[1].configuration = result.rows[0].configuration;
  result.rows[0].configuration.profile = kModelOfLiveRobot;
  result.rows[1].configuration.profile = kLiveRobot;
  const std::vector<Table> all = tables({result, {}, {}});
  const auto live =
      std::find_if(all.begin(), all.end(), [](const Table& table) { return table.id == "live"; });
  ASSERT_NE(live, all.end());
  ASSERT_EQ(live->rows.size(), 1u);
  EXPECT_EQ(live->rows[0].size(), live->columns.size());
}

TEST(Tables, AreMarkdown) {
  EXPECT_EQ(markdown(sample()), R"(**Findings of 50 % of \<all\>**

| name | ratio: ours | ratio: paper |
| :-- | --: | --: |
| a\_b\|c | **1.00 ± 0.20** | ✓ |
| d | **−2.00 !** | **3.00 +** |
| e | 0.00 | – |

+ significantly better, ! significantly worse; without a sign not significant.

A note.
)");
}

TEST(Tables, AreJsonForTheScriptsOfReports) {
  const Json table = parse_json(tables_json({sample()}))[0];
  EXPECT_EQ(table["id"], "sample");
  EXPECT_EQ(table["columns"][0]["align"], "left");
  EXPECT_EQ(table["columns"][1]["group_latex"], "$r$");
  EXPECT_EQ(table["rows"][0][1], (Json{{"text", "1.00 ± 0.20"}, {"bold", true}}));
  EXPECT_EQ(table["rows"][1][1], (Json{{"text", "−2.00"}, {"strength", 0.5}, {"shade", "worse"}}));
  EXPECT_EQ(table["rows"][2][1], (Json{{"text", "0.00"}, {"shade", "not_significant"}}));
  EXPECT_EQ(table["notes"][0], "A note.");
}

TEST(Tables, OfAStudyAreAllThere) {
  std::vector<std::string> ids;
  for (const Table& table : tables(synthetic_findings(20))) {
    ids.push_back(table.id);
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.id;
  }
  EXPECT_EQ(ids,
            (std::vector<std::string>{"ablation", "honest", "root-causes", "comparison-paper-paper",
                                      "effects-paper-paper", "robustness-paper-paper", "learning",
                                      "order", "claims"}));
  EXPECT_TRUE(tables({}).empty());
}

TEST(Tables, HaveNoNegativeZeros) {
  EXPECT_EQ(number(-0.001), "0.00");
  EXPECT_EQ(number(-1.5), "−1.50");
  EXPECT_EQ(p_value(0.0001), "< 0.001");
}

}  // namespace
}  // namespace culprit::study
