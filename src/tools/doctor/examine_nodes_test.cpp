// Each kind of finding about a node or its process: exactly that fault, and nothing else is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/examine.h"
#include "doctor/test_picture.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Examine, D010TwoNodesOfOneName) {
  Picture picture = robot();
  picture.namesakes["/lidar"] = {{"/lidar", ros2::Vendor::kFastDds, "", 11},
                                 {"/lidar", ros2::Vendor::kFastDds, "rover2", 0}};
  picture.processes[11].is_left_over = true;
  const Finding finding = only_finding(picture);
  EXPECT_EQ(finding.code, "D010");
  EXPECT_EQ(finding.seen,
            "2 nodes have this name: process 11 (left over: its launcher has ended), "
            "a process on rover2");
}

TEST(Examine, D011WhatHasEndedAndD012WhatHangs) {
  Picture picture = robot();
  picture.unanswered["/slam"] = {4, false};
  EXPECT_EQ(only_finding(picture).code, "D012");
  EXPECT_EQ(only_finding(picture).seen,
            "it has not answered a question about its parameters for 4.0 s");
  picture.unanswered["/slam"].has_ended = true;
  EXPECT_EQ(only_finding(picture).code, "D011");

  Picture busy = robot();
  busy.asked = 9;
  for (const char* name : {"/a", "/b", "/c", "/d", "/e"}) busy.unanswered[name] = {4, false};
  EXPECT_EQ(only_finding(busy).gravity, Gravity::kWarning) << "so many do not hang at once";
  EXPECT_EQ(only_finding(busy).subject, "/a, /b, /c and 2 more");
  busy.asked = 10;
  EXPECT_THAT(examine(busy), SizeIs(5));

  Picture clients = robot();
  clients.nodes.push_back(node("/slam_clients", 12,
                               {publishes("/rosout"), serves("/slam_clients/get_parameters"),
                                publishes("/tree_log"), calls("/lidar/reset")}));
  clients.unanswered["/slam_clients"] = {4, false};
  EXPECT_THAT(examine(clients), IsEmpty()) << "its process answers, and nobody asks this node";
  clients.unanswered["/slam"] = {4, false};
  EXPECT_THAT(examine(clients), SizeIs(2)) << "no node of the process answers";
  clients.unanswered.erase("/slam");
  clients.nodes.front().endpoints.push_back(reads("/tree_log"));
  EXPECT_EQ(only_finding(clients).subject, "/slam_clients");

  Picture lost = robot();
  lost.comings["/remote"] = {{.at = 3s, .is_there = false, .was_lost = true}};
  EXPECT_EQ(only_finding(lost).code, "D011");
  lost.comings["/remote"][0].was_lost = false;
  EXPECT_THAT(examine(lost), IsEmpty()) << "it said good-bye";
}

TEST(Examine, D013WhatComesAgainAndAgain) {
  Picture picture = robot();
  picture.comings["/slam"] = {{.at = 3s, .is_there = false},
                              {.at = 4s, .is_there = true, .pid = 13}};
  EXPECT_EQ(only_finding(picture).code, "D013");
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kWarning);
  picture.comings["/slam"].push_back({.at = 5s, .is_there = false});
  picture.comings["/slam"].push_back({.at = 6s, .is_there = true, .pid = 14});
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kError);
  EXPECT_EQ(only_finding(picture).seen,
            "it was started again 2 times while the doctor looked, last as process 14");
}

TEST(Examine, D014WhatIsLeftOverFromAnEarlierLaunch) {
  Picture picture = robot();
  picture.processes[12] = {.program = "slam_toolbox", .is_left_over = true};
  EXPECT_EQ(only_finding(picture).code, "D014");
  EXPECT_EQ(only_finding(picture).subject, "/slam (process 12, slam_toolbox)");
}

TEST(Examine, D015WhatNobodyDrivesOn) {
  Picture picture = robot();
  picture.lifecycles = {{"/lidar", {"inactive", "inactive", 4s}},
                        {"/slam", {"active", "active", 4s}}};
  EXPECT_EQ(only_finding(picture).code, "D015");
  EXPECT_EQ(only_finding(picture).seen,
            "it is inactive, 1 of 2 lifecycle nodes are active, and no manager would change that");
  EXPECT_EQ(only_finding(picture).matters, "/slam waits for what it publishes");

  Picture managed = picture;
  managed.nodes.push_back(node("/manager", 13, {calls("/lidar/change_state")}));
  EXPECT_THAT(examine(managed), IsEmpty()) << "its manager will, or will not, as it likes";
  managed.nodes.back().node.name = "/__mode_manager";
  EXPECT_THAT(examine(managed), IsEmpty()) << "that of system modes is hidden";
  managed.nodes.back().node.name = "/_culprit_survey";
  EXPECT_EQ(only_finding(managed).code, "D015") << "a node that only looks does not drive";
  Picture on_its_way = picture;
  on_its_way.lifecycles["/lidar"].last = "activating";
  EXPECT_THAT(examine(on_its_way), IsEmpty());
  Picture unread = picture;
  unread.nodes[1].endpoints.clear();
  EXPECT_THAT(examine(unread), IsEmpty()) << "a part that is not needed now";
  Picture all = picture;
  all.lifecycles["/slam"] = all.lifecycles["/lidar"];
  EXPECT_THAT(examine(all), IsEmpty()) << "a robot that has not begun";
}

TEST(Examine, D016WhatIsStuckInATransition) {
  Picture picture = robot();
  picture.lifecycles["/lidar"] = {"activating", "activating", 4s};
  EXPECT_EQ(only_finding(picture).code, "D016");
  EXPECT_EQ(only_finding(picture).seen, "it has been activating for 4 s at least");
  picture.lifecycles["/lidar"].last = "active";
  EXPECT_THAT(examine(picture), IsEmpty());
}

// A process of /slam that had so much memory each second, and used so much of a core.
Picture robot_with_process(std::vector<std::int64_t> megabytes, double cores = 0.1) {
  Picture picture = robot();
  picture.free_memory = 4'000'000'000;
  Process& process = picture.processes[12];
  process.age_at_first = 1h;
  process.program = "slam";
  for (std::size_t i = 0; i < megabytes.size(); ++i)
    process.samples.push_back(
        {i * 1s, from_seconds(cores * static_cast<double>(i)), megabytes[i] * 1'000'000});
  return picture;
}

TEST(Examine, D017WhatEatsMemory) {
  Picture picture = robot_with_process({100, 110, 121, 130, 142, 150, 160, 171, 180});
  EXPECT_EQ(only_finding(picture).code, "D017");
  EXPECT_EQ(only_finding(picture).seen, "its memory grew by 80 MB in 8 s, from 100 MB to 180 MB");
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kError) << "six minutes are left";
  picture.free_memory = 40'000'000'000;
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kWarning);
  picture.free_memory = 400'000'000'000;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it takes half a day";
  picture.free_memory = 4'000'000'000;
  picture.processes[12].age_at_first = 20s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it is starting";

  EXPECT_THAT(examine(robot_with_process({100, 150, 120, 160, 110, 150, 130, 170, 120})), IsEmpty())
      << "it comes and goes";
  EXPECT_THAT(examine(robot_with_process({100, 180, 180, 180, 180, 180, 180, 180, 180})), IsEmpty())
      << "it grew once";
  EXPECT_THAT(examine(robot_with_process({100, 101, 102, 103, 104, 105, 106, 107, 108})), IsEmpty())
      << "that is little";
}

TEST(Examine, D018WhatEatsACore) {
  Picture picture = robot_with_process(std::vector<std::int64_t>(9, 100), 1.0);
  picture.processes[12].busiest_thread = 0.99;
  EXPECT_EQ(only_finding(picture).code, "D018");
  EXPECT_EQ(only_finding(picture).seen, "one of its threads never waited: 99 % of a core for 8 s");
  picture.processes[12].busiest_thread = 0.6;
  EXPECT_THAT(examine(picture), IsEmpty()) << "several threads that work and wait";
}

TEST(Examine, D019WhatIsNotAsItWasStarted) {
  Picture picture = robot();
  picture.processes[12].parameters["/slam"] = {{"rate", "10"}, {"map", "office"}};
  picture.parameters["/slam"] = {{"rate", "5"}, {"map", "office"}, {"other", "1"}};
  EXPECT_EQ(only_finding(picture).code, "D019");
  EXPECT_EQ(only_finding(picture).seen, "rate is 5, started with 10");
  picture.parameters["/slam"]["rate"] = "10";
  EXPECT_THAT(examine(picture), IsEmpty());
}

TEST(Examine, D020WhatReportsItselfIll) {
  Picture picture = robot();
  picture.statuses["motor"].report = {2, "motor", "overheated", "m1", {}};
  picture.statuses["battery"].report = {1, "battery", "low", "b1", {}};
  picture.statuses["gps"].report = {3, "gps", "", "g1", {}};
  const std::vector<Finding> findings = examine(picture);
  ASSERT_THAT(findings, SizeIs(2));
  EXPECT_EQ(findings[0].seen, "its diagnostic status is ERROR: overheated");
  EXPECT_EQ(findings[0].gravity, Gravity::kError);
  EXPECT_EQ(findings[1].subject, "gps") << "the worst first";
  EXPECT_EQ(findings[1].gravity, Gravity::kWarning);
}

TEST(Examine, D021WhatIsNotReportedAnyMore) {
  Picture picture = robot();
  picture.looked = 20s;
  picture.statuses["motor"] = {{0, "motor", "", "", {}}, 6, 1s, 6s};
  EXPECT_EQ(only_finding(picture).code, "D021");
  EXPECT_EQ(only_finding(picture).seen,
            "its diagnostic status came every 1 s, and not any more for 14 s");
  picture.statuses["motor"].last = 16s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "five pauses are no silence";
  picture.statuses["motor"].last = 2s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "a burst has no rhythm";
}

}  // namespace
}  // namespace culprit::doctor
