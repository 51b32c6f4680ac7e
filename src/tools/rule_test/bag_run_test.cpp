// Tests of rules that play a recording.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/test_recording.h"
#include "base/test_folder.h"
#include "plan/paper_planner.h"
#include "rule_test/file_run.h"

namespace culprit::rule_test {
namespace {

namespace recorded = bag_doctor::test;
using testing::AllOf;
using testing::HasSubstr;

class BagTests : public testing::Test {
 protected:
  BagTests() {
    std::ofstream(folder_.path() / "lidar.rules")
        << "COMPONENT lidar NODE /lidar LAUNCH \"lidar\"\nCOMPONENT camera NODE /camera LAUNCH "
           "\"camera\"\n"
           "RULE LidarDead\n  POLICIES ERROR\n  TRIGGER age(/scan) > 1s\n    STRATEGY replace 50 "
           "10\n"
           "      ADAPTATION lidar redeploy 3\n"
           "RULE CameraDead\n  POLICIES ERROR\n  TRIGGER age(/image) > 1s\n    STRATEGY again 50 "
           "10\n"
           "      ADAPTATION camera redeploy 3\n";
    recorded::Recording recording;  // the lidar is silent from 10 s on
    for (int i = 0; i < 200; ++i) {
      if (i < 100)
        recording.add("/scan", "sensor_msgs/msg/LaserScan", i * 0.1, recorded::scan(i * 0.1, i));
      recording.add("/image", "std_msgs/msg/Float64", i * 0.1 + 0.01, recorded::number(0, i));
    }
    recording.write(folder_.path() / "drive.mcap");
  }

  FileRun run(const std::string& test) {
    const auto file = folder_.path() / "a.test";
    std::ofstream(file) << "RULES lidar.rules\nTEST drive\n" << test;
    return run_file(
        file.string(), "", [] { return std::make_unique<PaperPlanner>(); }, Colour::kOff);
  }

  const culprit::test::TestFolder folder_;
};

TEST_F(BagTests, ExpectWhatTheRulesSeeInIt) {
  const FileRun seen =
      run("  BAG drive.mcap\n  EXPECT LidarDead DETECTED AFTER 10.8s BY 11.2s\n  EXPECT NOT "
          "CameraDead\n"
          "  EXPECT BLAME lidar\n  EXPECT NOT BLAME camera\n");
  ASSERT_TRUE(seen.is_usable) << seen.complaints;
  EXPECT_THAT(seen.output, HasSubstr("  ok      drive (19.91 s)")) << seen.output;
}

TEST_F(BagTests, SayWhatHappenedInstead) {
  EXPECT_THAT(
      run("  BAG drive.mcap\n  EXPECT NOT LidarDead\n  EXPECT BLAME camera\n").output,
      AllOf(HasSubstr("EXPECT NOT LidarDead: it happened at 10.9"),
            HasSubstr("EXPECT BLAME camera: it did not happen"), HasSubstr("LidarDead detected")));
}

TEST_F(BagTests, EndWithTheirRun) {
  EXPECT_THAT(run("  BAG drive.mcap\n  RUN 5s\n  EXPECT NOT LidarDead\n").output,
              HasSubstr("  ok      drive (5 s)"));
}

TEST_F(BagTests, FailIfThereIsNoSuchRecording) {
  EXPECT_THAT(run("  BAG other.mcap\n  EXPECT NOT LidarDead\n").output,
              AllOf(HasSubstr("FAILED"), HasSubstr("other.mcap")));
}

TEST_F(BagTests, HaveNoScript) {
  const FileRun seen = run("  BAG drive.mcap\n  TOPIC /scan 0s: 10Hz\n  EXPECT NOT LidarDead\n");
  EXPECT_FALSE(seen.is_usable);
  EXPECT_THAT(seen.complaints, HasSubstr("a test of a BAG has no script"));
}

}  // namespace
}  // namespace culprit::rule_test
