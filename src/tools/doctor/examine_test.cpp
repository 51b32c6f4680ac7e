// Each kind of finding: exactly that fault, and nothing else is found; and what is no fault is not.
#include "doctor/examine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/nodes_to_ask.h"
#include "doctor/wanted_topics.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr ros2::Qos kBestEffort{.reliability = ros2::Reliability::kBestEffort};
constexpr ros2::Qos kLatched{.durability = ros2::Durability::kTransientLocal};
constexpr const char* kScan = "sensor_msgs/msg/LaserScan";
constexpr const char* kString = "std_msgs/msg/String";

ros2::GraphEndpoint publishes(std::string topic, ros2::Qos qos = {}, std::string type = kScan) {
  return {EndpointKind::kPublisher, std::move(topic), std::move(type), qos};
}
ros2::GraphEndpoint reads(std::string topic, ros2::Qos qos = {}, std::string type = kScan) {
  return {EndpointKind::kSubscriber, std::move(topic), std::move(type), qos};
}
ros2::GraphEndpoint serves(std::string service, std::string type = "std_srvs/srv/Trigger") {
  return {EndpointKind::kServer, std::move(service), std::move(type), {}};
}
ros2::GraphEndpoint calls(std::string service, std::string type = "std_srvs/srv/Trigger") {
  return {EndpointKind::kClient, std::move(service), std::move(type), {}};
}

Node node(std::string name, int pid, std::vector<ros2::GraphEndpoint> endpoints) {
  return {{std::move(name), ros2::Vendor::kFastDds, "", pid}, std::move(endpoints)};
}

// A robot of two nodes: /lidar with `from`, /slam with `to`.
Picture robot_with(ros2::GraphEndpoint from, ros2::GraphEndpoint to) {
  Picture picture;
  picture.looked = 8s;
  picture.nodes = {node("/lidar", 11, {std::move(from)}), node("/slam", 12, {std::move(to)})};
  return picture;
}

Picture robot() { return robot_with(publishes("/scan"), reads("/scan")); }

// The only one that there is.
Finding only_finding(const Picture& picture) {
  const std::vector<Finding> findings = examine(picture);
  EXPECT_THAT(findings, SizeIs(1));
  return findings.empty() ? Finding{} : findings.front();
}

TEST(Examine, FindsNothingWhereEverybodyHearsEverybody) {
  EXPECT_THAT(examine(robot()), IsEmpty());
  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/scan", kBestEffort))), IsEmpty());
  EXPECT_THAT(examine(robot_with(publishes("/map", kLatched), reads("/map"))), IsEmpty())
      << "it misses what was published before, as it asked for";
  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/joy"))), IsEmpty())
      << "an input that nobody feeds, and nobody may mean";
}

// ---- connections

TEST(Examine, D001ReliabilityThatIsNotOffered) {
  const Finding finding = only_finding(robot_with(publishes("/scan", kBestEffort), reads("/scan")));
  EXPECT_EQ(finding.code, "D001");
  EXPECT_EQ(finding.gravity, Gravity::kError);
  EXPECT_EQ(finding.subject, "/scan: /lidar → /slam");
  EXPECT_EQ(finding.seen, "reliability: offered is best effort, requested is reliable");
  EXPECT_EQ(finding.remedy, "let /lidar offer reliable, or /slam request best effort");
  EXPECT_THAT(finding.nodes, ElementsAre("/lidar", "/slam"));
  EXPECT_EQ(finding.topic, "/scan");
}

TEST(Examine, D001EveryPolicyWithBothValues) {
  struct Case {
    ros2::Qos offered, requested;
    const char* seen;
  };
  const Case cases[] = {
      {{}, kLatched, "durability: offered is volatile, requested is transient local"},
      {{}, {.deadline = 100ms}, "deadline: offered is none, requested is 0.1 s"},
      {{.deadline = 1s}, {.deadline = 100ms}, "deadline: offered is 1 s, requested is 0.1 s"},
      {{},
       {.liveliness = ros2::Liveliness::kManualByTopic},
       "liveliness: offered is automatic, requested is manual by topic"},
      {{}, {.liveliness_lease = 3s}, "liveliness lease: offered is none, requested is 3 s"},
      {{.ownership = ros2::Ownership::kExclusive},
       {},
       "ownership: offered is exclusive, requested is shared"},
      {{.keys = ros2::Keys::kSome}, {}, "keys: offered is some, requested is none"},
      {kBestEffort, kLatched,
       "reliability: offered is best effort, requested is reliable; "
       "durability: offered is volatile, requested is transient local"},
  };
  for (const Case& each : cases) {
    const Finding finding =
        only_finding(robot_with(publishes("/scan", each.offered), reads("/scan", each.requested)));
    EXPECT_EQ(finding.code, "D001");
    EXPECT_EQ(finding.seen, each.seen);
  }
  const ros2::Qos more{.durability = ros2::Durability::kTransientLocal,
                       .deadline = 100ms,
                       .liveliness = ros2::Liveliness::kManualByTopic,
                       .liveliness_lease = 1s};
  const ros2::Qos less{.deadline = 1s, .liveliness_lease = 2s};
  EXPECT_THAT(examine(robot_with(publishes("/scan", more), reads("/scan", less))), IsEmpty());
}

TEST(Examine, D001IsReportedOnceForAllThatDoNotReceiveFromAPublisher) {
  Picture picture = robot_with(publishes("/scan", kBestEffort), reads("/scan"));
  for (const char* other : {"/nav", "/map", "/log", "/safety"})
    picture.nodes.push_back(node(other, 13, {reads("/scan")}));
  EXPECT_EQ(only_finding(picture).subject, "/scan: /lidar → /log, /map, /nav and 2 more");
  // Each endpoint counts, not only the first of a node.
  Picture both = robot_with(publishes("/scan"), reads("/scan"));
  both.nodes[0].endpoints.push_back(publishes("/scan", kBestEffort));
  EXPECT_EQ(only_finding(both).code, "D001");
}

TEST(Examine, D002TypesThatDiffer) {
  const Finding finding = only_finding(
      robot_with(publishes("/scan"), reads("/scan", kBestEffort, "sensor_msgs/msg/PointCloud2")));
  EXPECT_EQ(finding.code, "D002");
  EXPECT_EQ(finding.seen,
            "published as sensor_msgs/msg/LaserScan, subscribed to as sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(only_finding(robot_with(serves("/reset"), calls("/reset", "std_srvs/srv/Empty"))).seen,
            "called as std_srvs/srv/Empty, served as std_srvs/srv/Trigger");
}

TEST(Examine, D003ANameThatIsOneLetterOffOrInAnotherNamespace) {
  const Finding slip = only_finding(robot_with(publishes("/scan"), reads("/scam")));
  EXPECT_EQ(slip.code, "D003");
  EXPECT_EQ(slip.gravity, Gravity::kWarning);
  EXPECT_THAT(slip.seen, HasSubstr("no node publishes /scam, and no node reads /scan of /lidar"));
  EXPECT_EQ(only_finding(robot_with(publishes("/front/scan"), reads("/scan"))).code, "D003");
  EXPECT_EQ(only_finding(robot_with(serves("/robot/reset"), calls("/reset"))).code, "D003");

  EXPECT_THAT(examine(robot_with(publishes("/scan"), reads("/scam", {}, kString))), IsEmpty())
      << "another type is another thing";
  EXPECT_THAT(examine(robot_with(serves("/a/get_parameters"), calls("/b/get_parameters"))),
              IsEmpty())
      << "every node has these";
  Picture read = robot_with(publishes("/scan_1"), reads("/scan_2"));
  read.nodes[1].endpoints.push_back(reads("/scan_1"));
  EXPECT_THAT(examine(read), IsEmpty()) << "the near one has its reader";
}

TEST(Examine, D004WhatAllOthersOfItsKindHave) {
  Picture picture = robot();
  picture.nodes = {node("/cameras", 11, {}), node("/detector", 12, {})};
  for (const char* topic : {"/camera_1/image", "/camera_2/image", "/camera_3/image"}) {
    picture.nodes[0].endpoints.push_back(publishes(topic));
    picture.nodes[1].endpoints.push_back(reads(topic));
  }
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.nodes[1].endpoints.pop_back();
  EXPECT_EQ(only_finding(picture).subject, "/camera_3/image: /cameras → no subscriber");
  EXPECT_EQ(only_finding(picture).code, "D004");
  picture.nodes[1].endpoints.pop_back();
  EXPECT_THAT(examine(picture), IsEmpty()) << "one of three is no rule";

  Picture wheels = robot();
  wheels.nodes = {node("/driver", 11, {}), node("/wheels", 12, {})};
  for (const char* topic : {"/left/speed", "/right/speed", "/rear/speed"}) {
    wheels.nodes[1].endpoints.push_back(reads(topic));
    if (std::string(topic) != "/rear/speed") wheels.nodes[0].endpoints.push_back(publishes(topic));
  }
  EXPECT_EQ(only_finding(wheels).subject, "/rear/speed: no publisher → /wheels");
}

TEST(Examine, D005OneNameOfATypeAndTwoDefinitions) {
  Picture picture = robot();
  picture.nodes[0].endpoints[0].type_hash = "RIHS01_aaaaaaaaaaaaaaaa";
  EXPECT_THAT(examine(picture), IsEmpty()) << "the other does not say";
  picture.nodes[1].endpoints[0].type_hash = "RIHS01_bbbbbbbbbbbbbbbb";
  EXPECT_EQ(only_finding(picture).code, "D005");
  EXPECT_THAT(only_finding(picture).seen, HasSubstr("RIHS01_aaaaaaaa and RIHS01_bbbbbbbb"));
}

TEST(Examine, D006WhatIsLatchedWasPublishedBeforeItsReaderCame) {
  Picture picture = robot_with(publishes("/map", kLatched), reads("/map"));
  const ros2::SystemTime noon(1'000'000s);
  picture.flows["/map"].last_sent = noon;
  picture.processes[11].started = noon - 60s;
  picture.processes[12].started = noon - 50s;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it was there";
  picture.processes[12].started = noon + 30s;
  EXPECT_EQ(only_finding(picture).code, "D006");
  EXPECT_THAT(only_finding(picture).seen, HasSubstr("published 30 s before /slam was started"));
  picture.nodes[1].endpoints[0].qos = kLatched;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it asked for it";
  picture.nodes[1].endpoints[0].qos = {};
  picture.processes.erase(11);
  EXPECT_THAT(examine(picture), IsEmpty()) << "its clock may be another";
}

TEST(Examine, D007AServiceOverTwoMiddlewares) {
  Picture picture = robot_with(serves("/reset"), calls("/reset"));
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.nodes[1].node.vendor = ros2::Vendor::kCyclone;
  EXPECT_EQ(only_finding(picture).code, "D007");
  EXPECT_EQ(only_finding(picture).seen, "the client is on Cyclone DDS, the server on Fast DDS");
  picture.nodes[0].endpoints[0].names_its_pair = true;
  EXPECT_THAT(examine(picture), IsEmpty()) << "it speaks both";
  picture.nodes[0].endpoints = {publishes("/scan")};
  picture.nodes[1].endpoints = {reads("/scan")};
  EXPECT_THAT(examine(picture), IsEmpty()) << "topics are shared";
}

TEST(Examine, D008NoPartitionInCommon) {
  Picture picture = robot();
  picture.nodes[0].endpoints[0].partitions = {"left"};
  EXPECT_EQ(only_finding(picture).code, "D008");
  EXPECT_EQ(only_finding(picture).seen,
            "partitions that it sends to: left; that are listened to: none");
  picture.nodes[1].endpoints[0].partitions = {"right", "le*"};
  EXPECT_THAT(examine(picture), IsEmpty());
}

TEST(Examine, D009WhatWasAnnouncedAndDidNotCome) {
  Picture picture = robot();
  Participant slam{.nodes = {"/slam"}};
  slam.undiscovered = 2;
  picture.participants = {slam};
  EXPECT_EQ(only_finding(picture).code, "D009");
  picture.comings["/slam"] = {{.at = 1s, .is_there = false}, {.at = 7s, .is_there = true}};
  EXPECT_THAT(examine(picture), ElementsAre(testing::Field(&Finding::code, "D013")))
      << "it has just come";
}

// ---- nodes

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

// ---- reach

TEST(Examine, D030NobodyThere) {
  Picture nobody;
  nobody.domain = 7;
  EXPECT_EQ(only_finding(nobody).subject, "domain 7");
  EXPECT_EQ(only_finding(nobody).seen, "no nodes were seen");
  nobody.other_domains = {{42, {"lidar_driver (process 4711)"}, {}}};
  EXPECT_EQ(only_finding(nobody).seen,
            "no nodes were seen; processes of this machine are on domain 42 (lidar_driver (process "
            "4711))");
}

TEST(Examine, D031OneOfALaunchIsOnAnotherDomain) {
  Picture picture = robot();
  picture.other_domains = {{42, {"camera (process 13)"}, {}}};
  EXPECT_THAT(examine(picture), IsEmpty()) << "another robot";
  picture.other_domains[0].siblings = {{"camera (process 13)", "/slam"}};
  EXPECT_EQ(only_finding(picture).code, "D031");
  EXPECT_EQ(only_finding(picture).seen,
            "it is on domain 42, and /slam, which the same launch started, on 0");
}

// A robot of /lidar on one computer and /slam on another.
Picture robot_on(const char* host, const char* other) {
  Picture picture = robot();
  picture.participants = {Participant{.nodes = {"/lidar"}, .host = host},
                          Participant{.nodes = {"/slam"}, .host = other}};
  return picture;
}

TEST(Examine, D032WhatCanBeReachedFromItsOwnComputerOnly) {
  Picture picture = robot_on("rover1", "rover2");
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.participants[0].is_local = true;
  EXPECT_EQ(only_finding(picture).code, "D032");
  EXPECT_EQ(only_finding(picture).subject, "/lidar");
  picture.participants[1].host = "rover1";
  EXPECT_THAT(examine(picture), IsEmpty()) << "all on one computer";
}

TEST(Examine, D033SomeAreSecuredAndSomeAreNot) {
  Picture picture = robot_on("rover1", "rover1");
  picture.participants.push_back({.pid = 13, .is_secured = true});
  EXPECT_EQ(only_finding(picture).code, "D033");
  EXPECT_EQ(only_finding(picture).seen,
            "they are not secured, and 1 participant of the domain is (process 13)");
  for (Participant& each : picture.participants) each.is_secured = true;
  EXPECT_THAT(examine(picture), IsEmpty());
}

TEST(Examine, D034DistributionsThatDoNotUnderstandEachOther) {
  Picture picture = robot_on("rover1", "rover1");
  picture.participants[0].form = ros2::GidSize::kHumbleAndOlder;
  picture.participants[1].form = ros2::GidSize::kHumbleAndOlder;
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.participants[1].form = ros2::GidSize::kIronAndNewer;
  EXPECT_EQ(only_finding(picture).code, "D034");
  EXPECT_EQ(only_finding(picture).seen,
            "they are of ROS 2 Humble or older, and others of Iron or newer: /slam");
  picture.participants[1].nodes = {"/culprit"};
  EXPECT_THAT(examine(picture), IsEmpty()) << "culprit speaks as the others do";
}

TEST(Examine, D035SharedMemoryThatIsNotShared) {
  Picture picture = robot_on("rover1", "rover1");
  for (int i = 0; i < 2; ++i) {
    picture.participants[i].pid = 11 + i;
    picture.participants[i].shares_memory = true;
    picture.processes[11 + i].shared_memory = 5;
  }
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.processes[12].shared_memory = 6;
  EXPECT_EQ(only_finding(picture).code, "D035");
  picture.participants[1].host_number = 7;
  EXPECT_THAT(examine(picture), IsEmpty()) << "they send over the network";
}

TEST(Examine, D036SharedMemoryThatTheOtherDoesNotRead) {
  Picture picture = robot_on("rover1", "rover1");
  for (int i = 0; i < 2; ++i) picture.participants[i].pid = 11 + i;
  picture.processes[11].ports_read = {"fastrtps_port7410"};
  picture.processes[12].ports_read = {"fastrtps_port7412"};
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.processes[11].ports_lost = {"fastrtps_port7414"};
  EXPECT_THAT(examine(picture), IsEmpty()) << "nobody has that number now";
  picture.processes[11].ports_lost = {"fastrtps_port7412"};
  EXPECT_EQ(only_finding(picture).code, "D036");
}

// ---- messages and time

// /scan, received for this long with these pauses.
Picture robot_with_flow(Duration listened, std::vector<Duration> pauses, ros2::Qos requested = {}) {
  Picture picture = robot_with(publishes("/scan", {.deadline = 1ms}), reads("/scan", requested));
  Flow& flow = picture.flows["/scan"];
  flow.listened = listened;
  flow.messages = pauses.size() + 1;
  flow.pauses = std::move(pauses);
  return picture;
}

TEST(Examine, D040LaterThanTheDeadline) {
  const ros2::Qos within_200_ms{.deadline = 200ms};
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
  latched.nodes[0].endpoints[0].qos.durability = ros2::Durability::kTransientLocal;
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

TEST(Examine, D060ADiskThatIsFull) {
  Picture picture = robot();
  picture.disks = {{"/home/robot", "the logs of /slam", 500'000'000'000, 20'000'000'000, 0}};
  EXPECT_THAT(examine(picture), IsEmpty());
  picture.disks[0].taken = 80'000'000'000;
  EXPECT_EQ(only_finding(picture).code, "D060");
  EXPECT_THAT(only_finding(picture).seen, HasSubstr("at the rate of now none in 2 s"));
  picture.disks[0] = {"/home/robot", "the logs of /slam", 500'000'000'000, 1'500'000'000, 0};
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kError) << "a third of a percent";
  picture.disks[0].size = 40'000'000'000;
  EXPECT_EQ(only_finding(picture).gravity, Gravity::kWarning);
  picture.disks[0] = {"/boot", "the folder of /slam", 500'000'000, 400'000'000, 0};
  EXPECT_THAT(examine(picture), IsEmpty()) << "a small one";
}

// ---- what has to be listened to, and who is asked

TEST(NodesToAsk, AreAllOfASmallRobotAndSomeOfEachProcessOfALargeOne) {
  const auto nodes = [](std::uint8_t processes, int each) {
    std::vector<ros2::Graph::NodeView> all;
    for (std::uint8_t p = 0; p < processes; ++p) {
      for (int n = 0; n < each; ++n) {
        all.push_back(
            {{"/n" + std::to_string(p * each + n), ros2::Vendor::kFastDds, "", 1}, {}, {}});
        all.back().participant.bytes[0] = p;
      }
    }
    return all;
  };
  EXPECT_THAT(nodes_to_ask(nodes(3, 20), 0), SizeIs(60));
  EXPECT_THAT(nodes_to_ask(nodes(50, 2), 0), SizeIs(50));
  EXPECT_THAT(nodes_to_ask(nodes(200, 1), 0), SizeIs(200)) << "each process may hang";
  std::set<std::string> asked;
  for (std::size_t round = 0; round < 20; ++round) {
    const auto chosen = nodes_to_ask(nodes(10, 20), round);
    EXPECT_THAT(chosen, SizeIs(10));
    std::set<ros2::GuidPrefix> processes;
    for (const auto& view : chosen) {
      asked.insert(view.node.name);
      processes.insert(view.participant);
    }
    EXPECT_THAT(processes, SizeIs(10));
  }
  EXPECT_THAT(asked, SizeIs(200)) << "everybody in turn";

  const auto with_managed = [&](std::size_t how_many) {
    auto all = nodes(10, 20);
    for (std::size_t i = 0; i < how_many; ++i) {
      ros2::GraphEndpoint state;
      state.kind = EndpointKind::kServer;
      state.name = all[i].node.name + "/get_state";
      all[i].endpoints.push_back(state);
    }
    return all;
  };
  const auto managed = [](const std::vector<ros2::Graph::NodeView>& chosen) {
    std::set<std::string> names;
    for (const auto& view : chosen) {
      if (!view.endpoints.empty()) names.insert(view.node.name);
    }
    return names;
  };
  EXPECT_THAT(managed(nodes_to_ask(with_managed(30), 0)), SizeIs(30))
      << "nobody else knows their states";
  std::set<std::string> in_turn;
  for (std::size_t round = 0; round < 20; ++round) {
    const auto chosen = nodes_to_ask(with_managed(150), round);
    EXPECT_THAT(chosen, SizeIs(60));
    in_turn.merge(managed(chosen));
  }
  EXPECT_THAT(in_turn, SizeIs(150));
}

TEST(WantedTopics, AreThoseThatARobotsNodeReadsAndThatTellSomething) {
  Picture picture = robot();
  const auto names = [&](Extent extent) {
    std::vector<std::string> all;
    for (const WantedTopic& each : wanted_topics(picture, extent)) all.push_back(each.name);
    return all;
  };
  picture.nodes[0].endpoints = {
      publishes("/scan"), publishes("/unread"), publishes("/text", {}, kString),
      publishes("/map", kLatched, kString), publishes("/tf", {}, "tf2_msgs/msg/TFMessage")};
  picture.nodes[1].endpoints = {reads("/scan"), reads("/text", {}, kString),
                                reads("/map", {}, kString),
                                reads("/tf", {}, "tf2_msgs/msg/TFMessage")};
  picture.nodes.push_back(node("/rviz2", 13, {reads("/unread")}));
  EXPECT_THAT(names(Extent::kFindings), ElementsAre("/map", "/scan"));
  EXPECT_THAT(names(Extent::kEverything), ElementsAre("/map", "/scan", "/text"));
  picture.nodes[1].endpoints[1].qos.deadline = 100ms;
  EXPECT_THAT(names(Extent::kFindings), ElementsAre("/text", "/map", "/scan"))
      << "first those whose silence is a finding";
}

}  // namespace
}  // namespace culprit::doctor
