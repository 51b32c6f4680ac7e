// A regression test that is made of an incident passes as it is written, and fails once the rules miss the failure.
#include "incident_reports/regression.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "base/text_file.h"
#include "incident_reports/journal_incidents.h"
#include "journal/session.h"
#include "journal/writer.h"
#include "plan/bayes/bayes_planner.h"
#include "recorder/recording_folder.h"
#include "rule_test/file_run.h"

namespace culprit::incident_reports {
namespace {

namespace recorded = bag_doctor::test;
using culprit::test::value_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kLidarRules = R"(
COMPONENT lidar NODE /lidar LAUNCH "lidar"
RULE LidarDead
  POLICIES ERROR
  TRIGGER age(/scan) > 1s
    STRATEGY replace 50 10
      ADAPTATION lidar redeploy 3
RULE Unseen
  POLICIES ERROR REPORT
  TRIGGER age(/nobody) > 1s
)";

class RegressionTest : public testing::Test {
 protected:
  // 100 s of scans at 10 Hz, with a pause from 50 s to 55 s that culprit saw on the robot.
  void happen() {
    recorded::Recording recording;
    for (int i = 0; i < 1000; ++i) {
      const double time = i * 0.1;
      if (time < 50 || time > 55)
        recording.add("/scan", "sensor_msgs/msg/LaserScan", time,
                      recorded::scan(time, recorded::noise(static_cast<std::uint64_t>(i))));
      recording.add("/other", "std_msgs/msg/Float64", time, recorded::number(time, i));
    }
    recording.add("/tf_static", "tf2_msgs/msg/TFMessage", 0.5,
                  recorded::transform(0, "base", "laser"));
    std::filesystem::create_directories(folder_.path() / "recordings");
    recording.write(folder_.path() / "recordings" /
                    recorder::recording_name("rover", recorded::at(51), "LidarDead"));
    journal::Session session;
    session.rules_path = "lidar.rules";
    session.rules_text = kLidarRules;
    session.planner = Json::object();
    add(journal::kind::kSession, 0, journal::to_json(session));
    tell(51, {{"type", "failure_detected"}, {"rule", "LidarDead"}, {"criticality", "ERROR"}});
    tell(51.5, {{"type", "failure_detected"}, {"rule", "Unseen"}, {"criticality", "ERROR"}});
    tell(52, {{"type", "strategy_chosen"}, {"rule", "LidarDead"}, {"strategy", "replace"}});
    tell(55, {{"type", "failure_resolved"}, {"rule", "Unseen"}});
    tell(55, {{"type", "failure_resolved"}, {"rule", "LidarDead"}, {"strategy", "replace"}});
  }
  void tell(double after, Json event) {
    event["text"] = "something";
    event["time"] = recorded::at(after) - recorded::kBegin;
    add(journal::kind::kEvent, after, event);
  }
  void add(std::string_view kind, double after, const Json& body) {
    rows_.entries.push_back({0, recorded::at(after), std::string(kind), to_line(body)});
  }
  Expected<ExportedTest> exported() {
    auto writer = value_of(journal::Writer::open(folder_.path() / "a.journal", {}));
    EXPECT_TRUE(writer.append(rows_, recorded::kBegin, journal::Durability::kProcessEnd));
    rows_ = {};
    const auto journal = value_of(journal::Reader::open(folder_.path() / "a.journal"));
    const auto found = value_of(incidents_of(journal, 0));
    EXPECT_EQ(found.incidents.size(), 1u);
    return export_test(journal, found.incidents.front().id, folder_.path() / "recordings",
                       folder_.path() / "made");
  }
  static rule_test::FileRun run(const std::filesystem::path& file) {
    return rule_test::run_file(
        file.string(), "", [] { return std::make_unique<BayesPlanner>(); }, Colour::kOff);
  }

  const culprit::test::TestFolder folder_;
  journal::Batch rows_;
};

TEST_F(RegressionTest, PassesAsItIsWritten) {
  happen();
  const ExportedTest made = value_of(exported());
  EXPECT_THAT(
      value_of(read_text(made.test.string())),
      AllOf(HasSubstr("EXPECT LidarDead DETECTED BY 20"), HasSubstr("EXPECT BLAME lidar BY"),
            HasSubstr("# Unseen was detected on the robot"), Not(HasSubstr("EXPECT Unseen"))));
  const rule_test::FileRun first = run(made.test);
  ASSERT_TRUE(first.is_usable) << first.complaints;
  EXPECT_THAT(first.output, HasSubstr("  ok      incident")) << first.output;
}

TEST_F(RegressionTest, FailsOnceTheRulesMissIt) {
  happen();
  const ExportedTest made = value_of(exported());
  std::string rules = value_of(read_text(made.rules.string()));
  rules.replace(rules.find("> 1s"), 4, "> 9s");
  std::ofstream(made.rules) << rules;
  EXPECT_THAT(run(made.test).output, HasSubstr("EXPECT LidarDead DETECTED BY 20"));
}

TEST_F(RegressionTest, HasOnlyThatPartOfTheRecordingAndWhatIsLatched) {
  happen();
  const ExportedTest made = value_of(exported());
  auto bag = value_of(bag::BagFile::open(made.bag));
  bag::BagMessage message;
  ASSERT_TRUE(bag.next(message));
  EXPECT_EQ(bag.contents().topics()[message.topic].name, "/tf_static");
  std::int64_t last = 0;
  for (; bag.next(message); last = message.recorded_at)
    EXPECT_GE(message.recorded_at, recorded::at(31));
  EXPECT_LE(last, recorded::at(65.01));
  EXPECT_GE(last, recorded::at(64.8));
}

TEST_F(RegressionTest, IsNotMadeWithoutARecordingOrOverAnother) {
  happen();
  ASSERT_TRUE(exported());
  const auto again = exported();
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error(), HasSubstr("is there already"));
  std::filesystem::remove_all(folder_.path() / "recordings");
  std::filesystem::remove_all(folder_.path() / "made");
  const auto without = exported();
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error(), HasSubstr("there is no recording of it"));
}

}  // namespace
}  // namespace culprit::incident_reports
