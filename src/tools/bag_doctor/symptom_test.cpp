// The findings in recordings with one fault each, and their times.
#include <cmath>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/bag_report.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"

namespace culprit::bag_doctor {
namespace {

using culprit::test::value_of;
using doctor::Finding;
using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class SymptomTest : public testing::Test {
 protected:
  // 60 s of a sensor, so that something moves; `edit` may change or drop a message by its time.
  template <class Edit>
  void sensor(const std::string& topic, double rate, Edit edit) {
    for (int i = 0; i / rate < 60; ++i) {
      double time = i / rate, stamp = time - 0.01, value = test::noise(++count_);
      if (edit(time, stamp, value))
        recording_.add(topic, "sensor_msgs/msg/Imu", time, test::imu(stamp, value));
    }
  }
  void sensor(const std::string& topic, double rate = 20) {
    sensor(topic, rate, [](double&, double&, double&) { return true; });
  }

  BagReport report() {
    ros2::MessageLibrary library;
    return report_of(value_of(read_course(recording_.write(folder_.path() / "bag.mcap"), library)),
                     {});
  }
  std::vector<Finding> found() { return report().findings; }
  // "D201 error /imu at 19.9".
  static std::string short_of(const Finding& finding) {
    return fmt::format("{} {} {} at {:.1f}", finding.code, label(finding.gravity), finding.subject,
                       finding.when->from);
  }
  std::vector<std::string> shorts() {
    std::vector<std::string> all;
    for (const Finding& each : found()) all.push_back(short_of(each));
    return all;
  }

  const culprit::test::TestFolder folder_;
  test::Recording recording_;
  std::uint64_t count_ = 0;
};

TEST_F(SymptomTest, AGapOfASensor) {
  sensor("/imu", 20, [](double time, double, double) { return time < 20 || time > 26; });
  sensor("/other");
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(short_of(all[0]), "D201 error /imu at 19.9");
  EXPECT_NEAR(all[0].when->until, 26, 0.1);
  EXPECT_THAT(to_string(*all[0].when),
              AllOf(HasSubstr("at 19.950 s (2023-11-1"), HasSubstr(":39.950), for 6.1 s")));
}

TEST_F(SymptomTest, ASensorThatEndsEarly) {
  sensor("/imu", 20, [](double time, double, double) { return time < 20; });
  sensor("/other");
  EXPECT_THAT(shorts(), ElementsAre("D202 error /imu at 19.9"));
}

TEST_F(SymptomTest, ASensorThatNeverCame) {
  sensor("/other");
  recording_.announce("/odometry/filtered", "nav_msgs/msg/Odometry");
  EXPECT_THAT(shorts(), ElementsAre("D203 warning /odometry/filtered at 0.0"));
}

TEST_F(SymptomTest, ARateThatFalls) {
  int n = 0;
  sensor("/imu", 20, [&](double time, double, double) { return time < 30 || ++n % 2 == 0; });
  sensor("/other");
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].code, "D204");
  EXPECT_THAT(all[0].seen, HasSubstr("from 20 Hz to 10 Hz"));
  EXPECT_NEAR(all[0].when->from, 30, 1.5);
}

// The windows in which the rate is measured overlap.
TEST_F(SymptomTest, ARateThatFallsTwiceInShortOrderIsOneFinding) {
  int n = 0;
  sensor("/imu", 20, [&](double time, double, double) {
    const bool is_slow = time > 30 && time < 45 && (time < 37 || time > 37.6);
    return !is_slow || ++n % 2 == 0;
  });
  sensor("/other");
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].code, "D204");
  EXPECT_NEAR(all[0].when->until, 45, 1.5);
}

TEST_F(SymptomTest, NumbersThatBecomeNaN) {
  sensor("/imu", 20, [](double time, double, double& value) {
    if (time > 40 && time < 45) value = std::nan("");
    return true;
  });
  sensor("/other");
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(short_of(all[0]), "D205 error /imu at 40.0");
  EXPECT_NEAR(all[0].when->until, 45, 0.1);
}

TEST_F(SymptomTest, ASensorThatFreezes) {
  sensor("/imu", 20, [](double time, double, double& value) {
    if (time > 30 && time < 40) value = 0.25;
    return true;
  });
  sensor("/other");
  EXPECT_THAT(shorts(), ElementsAre("D206 error /imu at 30.1"));
}

TEST_F(SymptomTest, StampsThatLagRepeatOrGoBack) {
  sensor("/lags", 20,
         [](double time, double& stamp, double) { return stamp -= time > 30 ? 1.5 : 0, true; });
  sensor("/repeats", 20,
         [](double time, double& stamp, double) { return stamp = time > 50 ? 50 : stamp, true; });
  sensor("/back", 20, [](double time, double& stamp, double) {
    return stamp -= time > 30 && time < 30.1 ? 0.7 : 0, true;
  });
  sensor("/ahead", 20, [](double time, double& stamp, double) {
    return stamp += time > 30 && time < 40 ? 5 : 0, true;
  });
  EXPECT_THAT(
      shorts(),
      AllOf(Contains("D042 warning /lags at 30.1"), Contains("D208 warning /repeats at 50.0"),
            Contains("D044 error /back at 30.1"), Contains("D043 error /ahead at 30.1")));
}

TEST_F(SymptomTest, StampsOfAnotherClockThanTheRest) {
  const auto simulated = [](double, double& stamp, double) { return stamp -= 1.6999e9, true; };
  for (const char* topic : {"/imu", "/imu2", "/imu3", "/imu4"}) sensor(topic, 20, simulated);
  sensor("/real");
  int n = 0;
  sensor("/mixed", 20,
         [&](double, double& stamp, double) { return stamp -= ++n % 3 == 0 ? 1.6999e9 : 0, true; });
  EXPECT_THAT(shorts(),
              UnorderedElementsAre("D045 warning /real at 0.0", "D045 warning /mixed at 0.0"));
}

TEST_F(SymptomTest, AClockOfADeviceThatWasNeverSet) {
  sensor("/imu");
  sensor("/imu2");
  sensor("/lidar_imu", 20, [](double, double& stamp, double) { return stamp -= 1.6999e9, true; });
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(short_of(all[0]), "D042 warning /lidar_imu at 0.0");
  EXPECT_THAT(all[0].seen, HasSubstr("a clock that was never set"));
}

TEST_F(SymptomTest, StampsThatBecomeZeroOrRepeatNowAndThen) {
  sensor("/zero", 20, [](double time, double& stamp, double) {
    return stamp = time > 30 && time < 40 ? -1.7e9 : stamp, true;
  });
  sensor("/sticky", 20, [](double time, double& stamp, double) {
    return stamp = time > 30 && time < 40 ? std::floor(time * 4) / 4 : stamp, true;
  });
  sensor("/late", 20,
         [](double time, double& stamp, double) { return stamp -= time > 30 ? 0.3 : 0, true; });
  EXPECT_THAT(shorts(), AllOf(Contains("D044 error /zero at 30.1"),
                              Contains(HasSubstr("D208 warning /sticky at 30.")),
                              Contains("D042 warning /late at 30.1")));
}

TEST_F(SymptomTest, MessagesThatAreCutFromTheTimeOn) {
  for (int i = 0; i < 600; ++i) {
    const std::string whole = test::number(0, test::noise(static_cast<std::uint64_t>(i)));
    const bool is_cut = i >= 300 && i < 400;
    recording_.add("/x", "std_msgs/msg/Float64", i * 0.1, is_cut ? whole.substr(0, 6) : whole);
  }
  const auto all = found();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(short_of(all[0]), "D216 warning /x at 30.0");
  EXPECT_NEAR(all[0].when->until, 39.9, 0.1);
}

TEST_F(SymptomTest, AFrameWithTwoParentsAndATransformThatStops) {
  sensor("/other");
  for (int i = 0; i < 1200; ++i) {
    const double time = i * 0.05;
    recording_.add("/tf", "tf2_msgs/msg/TFMessage", time, test::transform(time, "odom", "base"));
    if (time > 10)
      recording_.add("/tf", "tf2_msgs/msg/TFMessage", time, test::transform(time, "map", "base"));
    if (time > 30) continue;
    recording_.add("/tf", "tf2_msgs/msg/TFMessage", time, test::transform(time, "base", "arm"));
    recording_.add("/tf", "tf2_msgs/msg/TFMessage", time, test::transform(time, "arm", "hand"));
  }
  EXPECT_THAT(shorts(), AllOf(Contains("D052 error tf: base at 10.1"),
                              Contains(HasSubstr("D051 error tf: base"))));
}

TEST_F(SymptomTest, WhatNodesSayOfThemselves) {
  sensor("/other");
  for (int i = 0; i < 60; ++i)
    recording_.add("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", i,
                   test::diagnostic(i, i < 30 ? 0 : 2, "camera: frames", "no frame"));
  recording_.add("/rosout", "rcl_interfaces/msg/Log", 29,
                 test::log(29, 50, "camera", "usb is gone"));
  recording_.add("/rosout", "rcl_interfaces/msg/Log", 28, test::log(28, 30, "camera", "a warning"));
  recording_.add("/lidar/transition_event", "lifecycle_msgs/msg/TransitionEvent", 20,
                 test::transition("activating", "inactive"));
  const auto all = shorts();
  EXPECT_THAT(all, Contains("D020 error diagnostics: camera: frames: /camera at 29.0"));
  EXPECT_THAT(all, Contains("D212 error log of /camera: /camera at 29.0"));
  EXPECT_THAT(all, Contains("D211 error /lidar at 20.0"));
}

TEST_F(SymptomTest, ValuesThatCannotBeReadAreLeftOut) {
  sensor("/imu");
  recording_.add("/x", "my_msgs/msg/Thing", 1, test::number(1, 1));
  recording_.announce("/y", "my_msgs/msg/Thing");
  EXPECT_THAT(report().left_out, Contains("the values of /x: their types are not known "
                                          "(--message-path FOLDER), or they are not in CDR"));
}

TEST_F(SymptomTest, OffersThatDoNotFitTogether) {
  sensor("/imu");
  recording_.offer("/imu",
                   "- reliability: 1\n  durability: 2\n- reliability: 2\n  durability: 2\n");
  recording_.add("/tf_static", "tf2_msgs/msg/TFMessage", 1, test::transform(1, "a", "b"));
  recording_.offer("/tf_static", "- reliability: reliable\n  durability: volatile\n");
  EXPECT_THAT(shorts(), ElementsAre("D213 warning /imu at 0.0", "D213 warning /tf_static at 0.0"));
}

}  // namespace
}  // namespace culprit::bag_doctor
