#include "incident_reports/bag_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::incident_reports {
namespace {

namespace recorded = bag_doctor::test;
using culprit::test::value_of;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kPageRules = R"(
ROBOT rover
COMPONENT lidar NODE /lidar LAUNCH "lidar"
SIGNAL speed TOPIC /speed FIELD data
RULE LidarDead
  POLICIES ERROR
  TRIGGER age(/scan) > 1s
    STRATEGY replace 50 10
      ADAPTATION lidar redeploy 3
RULE TooFast
  POLICIES WARNING REPORT
  TRIGGER speed > 7.5
RULE NoMap
  POLICIES WARNING REPORT
  TRIGGER age(/map) > 1s
)";

TEST(BagPage, ShowsWhatFailedWhenWithCurvesAndWhatCouldNotBeJudged) {
  const culprit::test::TestFolder folder;
  recorded::Recording recording;
  for (int i = 0; i < 300; ++i) {
    if (i < 100)
      recording.add("/scan", "sensor_msgs/msg/LaserScan", i * 0.1, recorded::scan(i * 0.1, i));
    recording.add("/speed", "std_msgs/msg/Float64", i * 0.1, recorded::number(0, i * 0.03));
  }
  const auto checked = check(Source("rover.rules", kPageRules));
  ASSERT_TRUE(checked.rules);
  const std::string page =
      value_of(bag_page(*checked.rules, std::make_unique<BayesPlanner>(),
                        {recording.write(folder.path() / "drive.mcap"), {}, 0}));
  EXPECT_THAT(
      page, AllOf(HasSubstr("<h1>drive.mcap, "),
                  HasSubstr("<td><b>lidar is held responsible</b></td>"), HasSubstr("<td>10.9 s, "),
                  HasSubstr("still there at the end"), HasSubstr("3, of which 2 fired"),
                  HasSubstr("seconds since the recording began"), HasSubstr("LidarDead"),
                  HasSubstr("<rect class=\"ERROR\""), HasSubstr("<rect class=\"WARNING\""),
                  HasSubstr("class=\"curve\""), HasSubstr("class=\"limit\""),
                  HasSubstr("NoMap could not be judged: "), HasSubstr("drive.mcap")));
}

TEST(BagPage, WithoutAFailureItHasTheCurvesOfAllRules) {
  const culprit::test::TestFolder folder;
  recorded::Recording recording;
  for (int i = 0; i < 100; ++i)
    recording.add("/speed", "std_msgs/msg/Float64", i * 0.1, recorded::number(0, i * 0.03));
  const auto checked = check(Source("rover.rules", kPageRules));
  ASSERT_TRUE(checked.rules);
  const std::string page =
      value_of(bag_page(*checked.rules, std::make_unique<BayesPlanner>(),
                        {recording.write(folder.path() / "drive.mcap"), {}, 0}));
  EXPECT_THAT(page, AllOf(HasSubstr("No rule fired."), HasSubstr("speed (/speed data)"),
                          testing::Not(HasSubstr("Failures over time"))));
}

TEST(BagPage, OfNoBagIsAnError) {
  const RuleSet none;
  EXPECT_FALSE(bag_page(none, std::make_unique<BayesPlanner>(), {"/nowhere/bag.mcap", {}, 0}));
}

}  // namespace
}  // namespace culprit::incident_reports
