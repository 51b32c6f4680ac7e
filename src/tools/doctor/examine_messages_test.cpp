// Each kind of finding about messages, their time and transforms: exactly that fault, and nothing else is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/examine.h"
#include "doctor/test_picture.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// ---- messages and time

// /scan, received for this long with these pauses.
Picture robot_with_flow(Duration listened, std::vector<Duration> pauses, rtps::Qos requested = {}) {
  Picture picture = robot_with(publishes("/scan", {.deadline = 1ms}), reads("/scan", requested));
  Flow& flow = picture.flows["/scan"];
  flow.listened = listened;
  flow.messages = pauses.size() + 1;
  flow.pauses = std::move(pauses);
  return picture;
}

TEST(Examine, D040LaterThanTheDeadline) {
  const rtps::Qos within_200_ms{.deadline = 200ms};
  std::vector<Duration> pauses(40, 100ms);
  EXPECT_THAT(examine(robot_with_flow(5s, pauses, within_200_ms)), IsEmpty());
  pauses[7] = 300ms;
  EXPECT_THAT(examine(robot_with_flow(5s, pauses, within_200_ms)), IsEmpty()) << "one may be lost";
  pauses[8] = pauses[9] = 500ms;
  const Finding late = only_finding(robot_with_flow(5s, pauses, within_200_ms));
  EXPECT_EQ(late.code, "D040");
  EXPECT_EQ(late.seen, "3 of 40 pauses were longer than the deadline of 0.2 s, the longest 0.5 s");

  Picture silent = robot_with_flow(5s, {}, within_200_ms);
  silent.flows["/scan"].messages = 0;
  std::vector<std::string> codes;
  for (const Finding& each : examine(silent)) codes.push_back(each.code);
  EXPECT_THAT(codes, ElementsAre("D040", "D041"));
}

TEST(Examine, D041ASensorIsSilent) {
  Picture picture = robot();
  picture.flows["/scan"].listened = 5s;
  EXPECT_EQ(only_finding(picture).code, "D041");
  EXPECT_EQ(only_finding(picture).subject, "/scan: /lidar → /slam");
  picture.flows["/scan"].messages = 1;
  EXPECT_THAT(examine(picture), IsEmpty());

  Picture brief = robot();
  brief.flows["/scan"].listened = 2s;
  EXPECT_THAT(examine(brief), IsEmpty());
  Picture events = robot_with(publishes("/go", {}, kString), reads("/go", {}, kString));
  events.flows["/go"].listened = 5s;
  EXPECT_THAT(examine(events), IsEmpty()) << "what comes when it comes";
  Picture inactive = robot();
  inactive.flows["/scan"].listened = 5s;
  inactive.lifecycles["/lidar"] = {"inactive", "inactive", 4s};
  EXPECT_THAT(examine(inactive), IsEmpty()) << "it is switched off";
}

TEST(Examine, D048MessagesAreLostOnTheWay) {
  Picture picture = robot_with_flow(5s, std::vector<Duration>(79, 50ms));
  picture.flows["/scan"].lost = 20;
  EXPECT_EQ(only_finding(picture).code, "D048");
  EXPECT_EQ(only_finding(picture).seen,
            "20 of 100 messages were sent and did not come here (20 %)");
  picture.flows["/scan"].lost = 1;
  EXPECT_THAT(examine(picture), IsEmpty()) << "while they find each other";
}

// /scan with stamps that are so old when they are sent.
Picture robot_with_stamps(Duration lag) {
  Picture picture = robot_with_flow(5s, std::vector<Duration>(40, 100ms));
  picture.flows["/scan"].stamps = Flow::Stamps{.count = 40, .lag = lag};
  return picture;
}

TEST(Examine, D042OldStampsD043FutureStampsD044StampsThatJumpBack) {
  EXPECT_THAT(examine(robot_with_stamps(100ms)), IsEmpty());
  EXPECT_THAT(examine(robot_with_stamps(-1s)), IsEmpty()) << "dated ahead, as localization does";
  EXPECT_EQ(only_finding(robot_with_stamps(3s)).code, "D042");
  EXPECT_EQ(only_finding(robot_with_stamps(3s)).seen, "its stamps are 3 s old when they are sent");
  EXPECT_EQ(only_finding(robot_with_stamps(-3s)).code, "D043");
  Picture jumps = robot_with_stamps(0s);
  jumps.flows["/scan"].stamps->jumps_back = 2;
  jumps.flows["/scan"].stamps->furthest_back = 4s;
  EXPECT_EQ(only_finding(jumps).code, "D044");
  EXPECT_EQ(only_finding(jumps).seen, "its time stamps jumped back 2 times, by 4 s at most");
  Picture latched = robot_with_stamps(1h);
  latched.nodes[0].endpoints[0].qos.durability = rtps::Durability::kTransientLocal;
  EXPECT_THAT(examine(latched), IsEmpty()) << "it was true then, and still is";

  // A bag that is played without /clock, and a camera that is off by a minute.
  Picture bag = robot_with_stamps(5000h);
  bag.nodes[0].endpoints.push_back(publishes("/imu"));
  bag.nodes[0].endpoints.push_back(publishes("/image"));
  for (const char* topic : {"/imu", "/image"}) {
    bag.nodes[1].endpoints.push_back(reads(topic));
    bag.flows[topic] = bag.flows["/scan"];
  }
  EXPECT_THAT(examine(bag), IsEmpty()) << "they agree";
  bag.flows["/image"].stamps->lag += 60s;
  EXPECT_EQ(only_finding(bag).subject, "/image: /lidar");
  EXPECT_EQ(only_finding(bag).code, "D042");
}

// /scan in a simulation in which a hundred seconds have passed.
Picture simulated_robot() {
  Picture picture = robot_with_stamps(1'000'000h);
  picture.nodes.push_back(
      node("/simulator", 13, {publishes("/clock", {}, "rosgraph_msgs/msg/Clock")}));
  picture.clock = SimulatedClock{.ticks = 50, .first = 100s, .last = 105s};
  picture.flows["/scan"].stamps->simulated_lag = 50ms;
  picture.uses_simulated_time = {{"/lidar", true}, {"/slam", true}, {"/simulator", false}};
  return picture;
}

TEST(Examine, D045RealTimeInASimulation) {
  EXPECT_THAT(examine(simulated_robot()), IsEmpty());
  Picture picture = simulated_robot();
  picture.flows["/scan"].stamps->lag = 100ms;
  picture.flows["/scan"].stamps->simulated_lag = -1'000'000h;
  EXPECT_EQ(only_finding(picture).code, "D045");
}

TEST(Examine, D046SimulatedTimeStandsStill) {
  Picture picture = simulated_robot();
  picture.clock->last = picture.clock->first;
  EXPECT_EQ(only_finding(picture).code, "D046");
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kWarning) << "somebody has paused it";
  picture.nodes.pop_back();
  picture.uses_simulated_time.erase("/simulator");
  picture.clock.reset();
  EXPECT_EQ(only_finding(picture).code, "D046");
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kError);
  EXPECT_EQ(only_finding(picture).subject, "/lidar and /slam");
}

TEST(Examine, D047SomeUseSimulatedTimeAndSomeDoNot) {
  Picture picture = simulated_robot();
  picture.nodes.push_back(node("/camera", 14, {publishes("/image", {}, "sensor_msgs/msg/Image")}));
  picture.nodes.push_back(node("/screen", 15, {reads("/text", {}, kString)}));
  picture.uses_simulated_time["/camera"] = false;
  picture.uses_simulated_time["/screen"] = false;
  EXPECT_EQ(only_finding(picture).code, "D047");
  EXPECT_EQ(only_finding(picture).subject, "/camera")
      << "a node that stamps nothing has its own time";
}

// ---- tf

Transform edge(const char* parent, const char* child, const char* node = "/state",
               bool is_static = false) {
  return {parent, child, node, node, is_static, 80, 0s, 8s, 20ms};
}

// map → odom → base → laser.
Picture robot_with_tree() {
  Picture picture = robot();
  picture.transforms = {edge("map", "odom", "/amcl"), edge("odom", "base", "/ekf"),
                        edge("base", "laser", "/state", true)};
  picture.transforms_listened = 6s;
  picture.flows["/scan"].messages = 10;
  picture.flows["/scan"].frames = {"laser"};
  return picture;
}

TEST(Examine, D050AFrameThatIsInNoTransform) {
  EXPECT_THAT(examine(robot_with_tree()), IsEmpty());
  Picture picture = robot_with_tree();
  picture.flows["/scan"].frames = {"laser_front"};
  EXPECT_EQ(only_finding(picture).code, "D050");
  EXPECT_EQ(only_finding(picture).subject, "tf: laser_front");
  picture.flows["/scan"].frames = {"/laser", ""};
  EXPECT_THAT(examine(picture), IsEmpty()) << "an old way to write it, and none";
  picture.flows["/scan"].frames = {"laser_front"};
  picture.transforms_listened = 1s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it may still come";
  picture.transforms.clear();
  EXPECT_THAT(examine(picture), IsEmpty()) << "a robot without tf";
}

TEST(Examine, D051AStaleTransform) {
  Picture picture = robot_with_tree();
  picture.transforms[1].last = 2s;
  EXPECT_EQ(only_finding(picture).code, "D051");
  EXPECT_EQ(only_finding(picture).subject, "tf: odom → base");
  EXPECT_THAT(only_finding(picture).seen, HasSubstr("not any more for 6 s"));
  picture.transforms[1].last = 8s;
  picture.transforms[1].lag = 5s;
  EXPECT_EQ(only_finding(picture).seen, "/ekf publishes it with stamps that are 5 s old");
  picture.clock = SimulatedClock{.ticks = 50, .first = 100s, .last = 105s};
  EXPECT_THAT(examine(picture), IsEmpty()) << "by another clock";
}

TEST(Examine, D052TwoParents) {
  Picture picture = robot_with_tree();
  picture.transforms.push_back(edge("map", "base", "/slam"));
  EXPECT_EQ(only_finding(picture).code, "D052");
  EXPECT_EQ(only_finding(picture).seen, "it has two parents: odom (/ekf) and map (/slam)");
}

TEST(Examine, D053TwoPublishersOfOneTransform) {
  Picture picture = robot_with_tree();
  picture.transforms.push_back(edge("odom", "base", "/wheels"));
  EXPECT_EQ(only_finding(picture).code, "D053");
  EXPECT_EQ(only_finding(picture).seen, "two publish it: /ekf and /wheels");
  picture.transforms.back().first = 8s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "one took over from the other";
  picture.transforms.back() = edge("base", "laser", "/other", true);
  EXPECT_THAT(examine(picture), IsEmpty()) << "what never changes may be said twice";
}

TEST(Examine, D054TreesThatNothingConnects) {
  Picture picture = robot_with_tree();
  picture.transforms.erase(picture.transforms.begin() + 1);
  EXPECT_EQ(only_finding(picture).code, "D054");
  EXPECT_EQ(only_finding(picture).subject, "tf: base and map");
  picture.transforms = {edge("robot1/odom", "robot1/base"), edge("robot2/odom", "robot2/base")};
  picture.flows.clear();
  EXPECT_THAT(examine(picture), IsEmpty()) << "two robots";
  picture.transforms = {edge("a", "b"), edge("b", "a")};
  EXPECT_THAT(examine(picture), SizeIs(testing::Le(1u))) << "a circle ends, too";
}

}  // namespace
}  // namespace culprit::doctor
