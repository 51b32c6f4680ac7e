#include "init/values.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "init/draft.h"
#include "init/update.h"
#include "language/checker.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// A topic that came 10 times a second.
RobotProfile with_topic(const std::string& topic, const std::string& type) {
  RobotProfile seen;
  seen.looked = 30s;
  seen.robot.nodes["/lidar"] = {.parameters = {}, .lifecycle = "", .pid = 12};
  seen.robot.topics[topic] = {type, {"/lidar"}, {}, {}, {}};
  seen.rhythms[topic] = {301, 30s, 130ms};
  seen.starts["/lidar"].command = {"/opt/lidar"};
  return seen;
}

// Noise of a sensor: mostly up and down.
double noise(int i) { return 0.01 * ((i * 7919) % 101); }

RobotProfile with_scan(double (*beam)(int)) {
  RobotProfile seen = with_topic("/scan", "sensor_msgs/msg/LaserScan");
  for (const char* field : {"ranges[0]", "ranges[60]", "ranges[90]", "ranges[150]", "ranges[180]"})
    for (int i = 0; i < 300; ++i) seen.fields["/scan"][field].note(beam(i));
  return seen;
}

RuleSet strict_rules(const RobotProfile& seen) {
  const Checked checked = check({"draft", draft(seen)}, Strictness::kStrict);
  EXPECT_THAT(checked.diagnostics, testing::IsEmpty()) << draft(seen);
  return checked.rules ? *checked.rules : RuleSet{};
}

TEST(Values, OfAScanThatJittersBeamsInSeveralDirectionsAreWatched) {
  const RobotProfile seen = with_scan([](int i) { return 3 + noise(i); });
  const RuleSet rules = strict_rules(seen);
  EXPECT_THAT(draft(seen), HasSubstr(R"(
# guess: 4 numbers of /scan were finite, and changed up and down by themselves.
# If they are no longer, a person is notified.
SIGNAL scan_ranges_0_ TOPIC /scan FIELD ranges[0]
SIGNAL scan_ranges_60_ TOPIC /scan FIELD ranges[60]
SIGNAL scan_ranges_90_ TOPIC /scan FIELD ranges[90]
SIGNAL scan_ranges_180_ TOPIC /scan FIELD ranges[180]
RULE scan_frozen
  POLICIES WARNING REPORT
  TRIGGER frozen(scan_ranges_0_, 2s) && frozen(scan_ranges_60_, 2s) && frozen(scan_ranges_90_, 2s) && frozen(scan_ranges_180_, 2s)
RULE scan_nan
  POLICIES WARNING FOR 1s REPORT
  TRIGGER isnan(scan_ranges_0_) && isnan(scan_ranges_60_) && isnan(scan_ranges_90_) && isnan(scan_ranges_180_)
)"));
  for (const Rule& rule : rules.rules) {
    EXPECT_TRUE(!rule.name.starts_with("scan_") || rule.strategies.empty()) << rule.name;
  }
}

TEST(Values, ThatStandStillOrMoveOnlyWithTheRobotMayStandStill) {
  for (double (*beam)(int) : {+[](int) { return 3.0; }, +[](int i) { return 3 + i * 0.01; },
                              +[](int i) { return 3 + std::sin(i * 0.05); },
                              +[](int i) { return i % 20 == 0 ? 3 + noise(i) : 3.0; }}) {
    const std::string text = draft(with_scan(beam));
    EXPECT_THAT(text, Not(HasSubstr("frozen"))) << text;
    EXPECT_THAT(text, HasSubstr("isnan")) << text;
  }
}

TEST(Values, OfOdometryJitterOnlyWhileTheRobotMoves) {
  RobotProfile seen = with_topic("/odom", "nav_msgs/msg/Odometry");
  for (int i = 0; i < 300; ++i) seen.fields["/odom"]["twist.twist.linear.x"].note(noise(i));
  EXPECT_THAT(draft(seen), Not(HasSubstr("frozen")));
  EXPECT_THAT(draft(seen), HasSubstr("TRIGGER isnan(odom_twist_twist_linear_x)\n"));
  (void)strict_rules(seen);
}

TEST(Values, ThatWereNotAlwaysFiniteOrCameSeldomHaveNoRule) {
  RobotProfile seen = with_scan([](int i) { return i == 7 ? NAN : noise(i); });
  EXPECT_THAT(draft(seen), Not(HasSubstr("SIGNAL")));
  seen = with_topic("/imu", "sensor_msgs/msg/Imu");
  for (int i = 0; i < 9; ++i) seen.fields["/imu"]["angular_velocity.z"].note(noise(i));
  EXPECT_THAT(draft(seen), Not(HasSubstr("SIGNAL")));
}

TEST(Values, OfAnotherFrameThanEverAreReported) {
  RobotProfile seen = with_scan(noise);
  for (int i = 0; i < 300; ++i) seen.fields["/scan"]["header.frame_id"].note(std::string("laser"));
  const RuleSet rules = strict_rules(seen);
  EXPECT_THAT(draft(seen), HasSubstr(R"(
# guess: all messages of /scan were in the frame laser. If they are in another one, a person is notified.
SIGNAL scan_frame TOPIC /scan FIELD header.frame_id
RULE scan_wrong_frame
  POLICIES WARNING FOR 1s REPORT
  TRIGGER scan_frame != "laser"
)"));
  for (const Rule& rule : rules.rules)
    EXPECT_TRUE(rule.name != "scan_wrong_frame" || rule.strategies.empty());
}

TEST(Values, OfAFrameThatVariesIsMissingOrNeedsEscapesHaveNoRule) {
  for (const std::vector<std::string>& frames :
       {std::vector<std::string>{"left", "right"}, {""}, {"a \"b\""}, {"two words"}}) {
    RobotProfile seen = with_scan(noise);
    for (std::size_t i = 0; i < 300; ++i)
      seen.fields["/scan"]["header.frame_id"].note(frames[i % frames.size()]);
    EXPECT_THAT(draft(seen), Not(HasSubstr("frame"))) << frames.front();
    (void)strict_rules(seen);
  }
}

TEST(Values, OfTwoPublishersAreNobodys) {
  RobotProfile seen = with_scan(noise);
  seen.robot.topics["/scan"].publishers.insert("/other");
  EXPECT_THAT(draft(seen), Not(HasSubstr("SIGNAL")));
}

TEST(Values, AreAddedToAFileThatDoesNotReadThem) {
  const RobotProfile seen = with_scan(noise);
  const std::string rules = "COMPONENT lidar NODE /lidar LAUNCH \"/opt/lidar\"\n";
  const auto changes = [&](const std::string& text) {
    std::string all;
    for (const Update::Change& each :
         update(text, *check({"it", text}).rules, seen, Packs::kNone).changes) {
      for (const std::string& line : each.added) all += line;
    }
    return all;
  };
  EXPECT_THAT(changes(rules), HasSubstr("RULE scan_frozen\n"));
  EXPECT_THAT(changes(rules + "SIGNAL mine TOPIC /scan FIELD ranges[3]\n"), Not(HasSubstr("RULE")));
  EXPECT_EQ(changes(draft(seen)), "");
}

}  // namespace
}  // namespace culprit::init
