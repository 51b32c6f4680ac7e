// Each kind of finding: exactly that fault, and nothing else is found; and what is no fault is not.
#include "doctor/examine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/test_picture.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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
    rtps::Qos offered, requested;
    const char* seen;
  };
  const Case cases[] = {
      {{}, kLatched, "durability: offered is volatile, requested is transient local"},
      {{}, {.deadline = 100ms}, "deadline: offered is none, requested is 0.1 s"},
      {{.deadline = 1s}, {.deadline = 100ms}, "deadline: offered is 1 s, requested is 0.1 s"},
      {{},
       {.liveliness = rtps::Liveliness::kManualByTopic},
       "liveliness: offered is automatic, requested is manual by topic"},
      {{}, {.liveliness_lease = 3s}, "liveliness lease: offered is none, requested is 3 s"},
      {{.ownership = rtps::Ownership::kExclusive},
       {},
       "ownership: offered is exclusive, requested is shared"},
      {{.keys = rtps::Keys::kSome}, {}, "keys: offered is some, requested is none"},
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
  const rtps::Qos more{.durability = rtps::Durability::kTransientLocal,
                       .deadline = 100ms,
                       .liveliness = rtps::Liveliness::kManualByTopic,
                       .liveliness_lease = 1s};
  const rtps::Qos less{.deadline = 1s, .liveliness_lease = 2s};
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
  const rtps::SystemTime noon(1'000'000s);
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

// ---- disks

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

}  // namespace
}  // namespace culprit::doctor
