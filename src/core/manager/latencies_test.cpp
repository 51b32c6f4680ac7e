#include <memory>

#include <gtest/gtest.h>

#include "manager/test_pipeline.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

// A lamp whose brightness is measured 2 s after its restart; the rule states 0.4 s.
class LateSensor {
 public:
  LateSensor()
      : robot(R"(
COMPONENT lamp NODE /lamp
RULE Dark
  POLICIES WARNING ATTEMPTS 1
  TRIGGER brightness < 0.5
    STRATEGY again 90 10
      ADAPTATION lamp restart 2
)") {
    robot.add("lamp");
    robot.discover();
    run_for(1s);
  }
  void run_for(Duration time) {
    for (const Time end = robot.now + time; robot.now < end;) {
      const std::size_t restarts = robot.count_asked("lamp: activate");
      if (restarts > restarts_) shown_ = robot.now + 2s;
      restarts_ = restarts;
      if (robot.now >= shown_) brightness = 1;
      robot.signal("brightness", Value(brightness), 50ms);
    }
  }
  void go_dark() {
    shown_ = Time::max();
    brightness = 0;
    run_for(10s);
  }

  TestRobot robot;
  double brightness = 1;

 private:
  std::size_t restarts_ = 0;
  Time shown_ = Time::max();
};

TEST(Latencies, AreLearnedAndAVerdictWaitsForThem) {
  LateSensor sensor;
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 1u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 0u);
  const auto& learned = sensor.robot.manager().knowledge().latencies.learned(RuleId(0));
  EXPECT_EQ(learned.count, 1);
  EXPECT_GE(learned.range.least, 1900ms);
  EXPECT_LE(learned.range.most, 2100ms);
  sensor.run_for(2min);  // it is proven well
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 1u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 1u);
  EXPECT_EQ(learned.count, 2);
}

TEST(Latencies, OfAnEarlierRunAreKnownFromTheBeginning) {
  LateSensor sensor;
  sensor.robot.manager().set_latency(RuleId(0), {1, {2s, 2100ms, 2s}});
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 0u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 1u);
}

TEST(BayesPlanner, LeavesWhatWasRepairedUpstreamTheTimeToSettle) {
  TestRobot robot = pipeline(std::make_unique<BayesPlanner>());
  robot.fail("camera", "redeploy", 20s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

}  // namespace
}  // namespace culprit::test
