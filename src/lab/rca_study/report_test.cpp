#include "rca_study/report.h"

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

}  // namespace
}  // namespace culprit::study::rca
