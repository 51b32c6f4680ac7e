#include "rca_study/rca_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "json/json.h"

namespace culprit::study::rca {
namespace {

RcaRow row(const std::string& planner, std::size_t components, double downtime_s, double wrong) {
  RcaRow row;
  row.planner = planner;
  row.setting.components = components;
  row.episodes = 1;
  row.downtime_s.add(downtime_s);
  row.wrong_component.add(wrong);
  return row;
}

TEST(RcaReport, SaysWhichPlannersNoOtherBeatsInTheSameSetting) {
  const std::vector<RcaRow> rows = {row("naive", 20, 5, 3), row("paper", 20, 6, 1),
                                    row("bayes", 20, 5, 1), row("optimum", 20, 1, 0),
                                    row("naive", 50, 9, 9)};
  const auto document = parse_json(rca_json({}, rows, Times::kLeftOut));
  EXPECT_EQ(document["rows"][0]["on_front"], false);
  EXPECT_EQ(document["rows"][1]["on_front"], false);
  EXPECT_EQ(document["rows"][2]["on_front"], true);
  EXPECT_TRUE(document["rows"][3]["on_front"].is_null()) << "it is a bound";
  EXPECT_EQ(document["rows"][4]["on_front"], true);
}

// Two comparisons are four tests: the weakest stays as it is, the others count for more than one.
TEST(RcaReport, CorrectsItsTestsForTheirNumber) {
  const auto sampled = [](const std::string& planner, double wrong, double recovery_s) {
    RcaRow row;
    row.planner = planner;
    row.episodes = 40;
    row.wrong_component = Moments::of_summary(wrong, 1, 40);
    row.recovery_s = Moments::of_summary(recovery_s, 10, 40);
    return row;
  };
  RcaCampaign campaign;
  campaign.settings = {RcaSetting{}};
  const std::vector<RcaRow> rows = {sampled("naive", 0.6, 20), sampled("paper", 9, 90),
                                    sampled("bayes", 0, 20)};
  const std::vector<std::string> notes = rca_table(campaign, rows, Times::kLeftOut).notes;
  // Welch: t 2.683 with 78 degrees, p 0.0089; two of the four are smaller.
  EXPECT_THAT(notes, testing::Contains(testing::HasSubstr(
                         "bayes beside naive: wrong components -0.60 (p 0.018), recovery +0.0 s "
                         "(p 1.000); Welch, Holm over the table.")));
}

}  // namespace
}  // namespace culprit::study::rca
