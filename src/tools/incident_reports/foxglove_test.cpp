#include "incident_reports/foxglove.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "json/json.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::incident_reports {
namespace {

namespace recorded = bag_doctor::test;
using culprit::test::value_of;
using testing::HasSubstr;
using testing::SizeIs;

constexpr const char* kFoxgloveRules = R"(
SIGNAL speed TOPIC /speed FIELD data
RULE LidarDead
  POLICIES ERROR REPORT
  TRIGGER age(/scan) > 1s
RULE TooFast
  POLICIES WARNING REPORT
  TRIGGER speed > 7.5
RULE NoMap
  POLICIES WARNING REPORT
  TRIGGER age(/map) > 1s
)";

class FoxgloveTest : public testing::Test {
 protected:
  std::filesystem::path recording() {
    recorded::Recording recording;
    for (int i = 0; i < 300; ++i) {
      if (i < 100)
        recording.add("/scan", "sensor_msgs/msg/LaserScan", i * 0.1, recorded::scan(i * 0.1, i));
      recording.add("/speed", "std_msgs/msg/Float64", i * 0.1, recorded::number(0, i * 0.03));
    }
    return recording.write(folder_.path() / "drive.mcap");
  }
  Expected<void> write(const std::filesystem::path& bag, const std::filesystem::path& file) {
    return write_foxglove(*checked_.rules, std::make_unique<BayesPlanner>(), {bag, {}, file});
  }

  const culprit::test::TestFolder folder_;
  const Checked checked_ = check(Source("rover.rules", kFoxgloveRules));
};

TEST_F(FoxgloveTest, ShowsEventsRulesAndSignalsAtTheTimesOfTheRecording) {
  const auto drive = recording();
  const auto file = folder_.path() / "seen.mcap";
  ASSERT_TRUE(write(drive, file));
  bag::BagFile original = value_of(bag::BagFile::open(drive));
  bag::BagMessage message;
  ASSERT_TRUE(original.next(message));
  const std::int64_t begin = message.recorded_at;

  bag::BagFile bag = value_of(bag::BagFile::open(file));
  std::map<std::string, std::vector<std::pair<double, Json>>> seen;
  while (bag.next(message)) {
    const bag::BagTopic& topic = bag.contents().topics()[message.topic];
    EXPECT_EQ(topic.encoding, "json");
    seen[topic.name].emplace_back(static_cast<double>(message.recorded_at - begin) * 1e-9,
                                  parse_json(message.bytes));
  }
  EXPECT_THAT(bag.contents().losses(), testing::IsEmpty());
  const auto& lidar = seen["/culprit/rules/LidarDead"];
  ASSERT_THAT(lidar, SizeIs(3));
  EXPECT_EQ(lidar[0].second["state"], "unknown");
  EXPECT_EQ(lidar[1].second["state"], "ok");
  EXPECT_EQ(lidar[2].second["state"], "failing");
  EXPECT_NEAR(lidar[2].first, 10.9, 0.01);
  ASSERT_THAT(seen["/culprit/rules/NoMap"], SizeIs(1));
  EXPECT_EQ(seen["/culprit/rules/NoMap"][0].second["state"], "unknown") << "no alarm is not health";
  const auto& speed = seen["/culprit/signals/speed"];
  ASSERT_THAT(speed, SizeIs(300));
  EXPECT_NEAR(speed[100].second["value"].get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(speed[100].first, 10.0, 1e-6);
  const auto& gaps = seen["/culprit/gaps/scan"];
  ASSERT_THAT(gaps, SizeIs(100));
  EXPECT_NEAR(gaps.back().second["value"].get<double>(), 20, 1e-6) << "until the end";
  std::string log;
  for (const auto& [at, line] : seen["/culprit/log"])
    log +=
        line["message"].get<std::string>() + " " + std::to_string(line["level"].get<int>()) + "\n";
  EXPECT_THAT(log, HasSubstr("LidarDead detected (ERROR) 4"));
  ASSERT_FALSE(seen["/culprit/incidents"].empty());
  EXPECT_EQ(seen["/culprit/incidents"][0].second["rules"][0], "LidarDead");
}

TEST_F(FoxgloveTest, ItsLayoutPlotsEachSignalWithItsLimits) {
  const Json layout = parse_json(foxglove_layout(*checked_.rules));
  const Json& panels = layout["configById"];
  ASSERT_TRUE(panels.contains("Plot!culprit2"));
  EXPECT_EQ(panels["Plot!culprit1"]["paths"][0]["value"], "/culprit/gaps/scan.value");
  EXPECT_EQ(panels["Plot!culprit2"]["paths"][0]["value"], "/culprit/signals/speed.value");
  EXPECT_EQ(panels["Plot!culprit2"]["paths"][1]["value"], "7.5");
  EXPECT_EQ(panels["StateTransitions!culprit1"]["paths"][1]["value"],
            "/culprit/rules/TooFast.state");
  // Each panel has its place.
  const std::string places = to_line(layout["layout"]);
  for (const auto& panel : panels.items())
    EXPECT_THAT(places, HasSubstr("\"" + panel.key() + "\""));
  EXPECT_EQ(layout_beside("/a/seen.mcap"), "/a/seen.layout.json");
}

TEST_F(FoxgloveTest, WritesNeitherOverTheRecordingNorWithoutOne) {
  const auto drive = recording();
  EXPECT_FALSE(write(drive, drive));
  EXPECT_TRUE(bag::BagFile::open(drive));
  EXPECT_FALSE(write("/nowhere/bag.mcap", folder_.path() / "out.mcap"));
}

}  // namespace
}  // namespace culprit::incident_reports
