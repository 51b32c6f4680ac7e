#include "study/tables/render.h"

#include <gtest/gtest.h>

#include "study/tables/columns.h"
#include "study/tables/study_tables.h"
#include "study/test_findings.h"

namespace culprit::study {
namespace {

Table sample() {
  return {"sample",
          "What 50 % of <all> find",
          {{"", "name", "", "", Align::kLeft},
           {"ratio", "ours", "$r$", ""},
           {"ratio", "paper", "$r$", ""}},
          {{{"a_b|c"}, {"1.00 ± 0.20", Shade::kNone, 0, true}, {"✓"}},
           {{"d"}, {"−2.00", Shade::kWorse, 0.5, false}, {"3.00", Shade::kBetter, 1, false}},
           {{"e"}, {"0.00", Shade::kNotSignificant, 0, false}, {"–"}}},
          {"A note."}};
}

TEST(Tables, AreAlignedInATerminal) {
  EXPECT_EQ(text(sample()), R"(What 50 % of <all> find

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
  EXPECT_EQ(markdown(sample()), R"(**What 50 % of \<all\> find**

| name | ratio: ours | ratio: paper |
| :-- | --: | --: |
| a\_b\|c | **1.00 ± 0.20** | ✓ |
| d | **−2.00 !** | **3.00 +** |
| e | 0.00 | – |

+ significantly better, ! significantly worse; without a sign not significant.

A note.
)");
}

TEST(Tables, AreLatexLikeThePapers) {
  EXPECT_EQ(latex(sample()),
            R"(% needs \usepackage{amsmath,amssymb,booktabs} and \usepackage[table]{xcolor}
\begin{table}[ht]
\centering
\caption{What 50 \% of $<$all$>$ find}
\label{tab:sample}
\begin{tabular}{lrr}
\toprule
 & \multicolumn{2}{c}{$r$} \\
\cmidrule(lr){2-3}
name & ours & paper \\
\midrule
a\_b$|$c & \textbf{1.00 $\pm$ 0.20} & \checkmark \\
d & \cellcolor{red!50}$-$2.00 & \cellcolor{green!100}3.00 \\
e & \cellcolor{gray!25}0.00 & \textendash{} \\
\bottomrule
\end{tabular}

\smallskip
{\footnotesize A note.}
\end{table}
)");
}

TEST(Tables, AreHtmlThatEscapesEverything) {
  const std::string page = html(sample());
  EXPECT_NE(page.find("What 50 % of &lt;all&gt; find"), std::string::npos) << page;
  EXPECT_NE(page.find("<th class=\"group\" colspan=\"2\" scope=\"colgroup\">ratio</th>"),
            std::string::npos)
      << page;
  EXPECT_NE(page.find("<td class=\"right worse\" style=\"--strength:0.50\">−2.00"),
            std::string::npos)
      << page;
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
