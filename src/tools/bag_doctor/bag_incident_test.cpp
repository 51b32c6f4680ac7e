// From where the graph of a recording comes, and what is made of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/bag_report.h"
#include "bag_doctor/symptom.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "language/checker.h"

namespace culprit::bag_doctor {
namespace {

using culprit::test::value_of;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kGraph = R"({
  "nodes": [{"name": "/camera", "pid": 7}, {"name": "/detector"}, {"name": "/tracker"}, {"name": "/lidar"}],
  "dependencies": [
    {"consumer": "/detector", "producer": "/camera", "channel": "/image"},
    {"consumer": "/tracker", "producer": "/camera", "channel": "/image"},
    {"consumer": "/planner", "producer": "/detector", "channel": "/detections"},
    {"consumer": "/planner", "producer": "/tracker", "channel": "/tracks"},
    {"consumer": "/planner", "producer": "/lidar", "channel": "/scan"}]})";

class IncidentTest : public testing::Test {
 protected:
  // At 10 Hz from `from` on, until `until`; for 60 s.
  void topic(const std::string& name, double until = 60, double from = 0) {
    for (int i = 0; from + i * 0.1 < until; ++i)
      recording_.add(name, "sensor_msgs/msg/Imu", from + i * 0.1,
                     test::imu(from + i * 0.1, test::noise(++count_)));
  }
  BagReport report(const RobotGraph& graph = {}) {
    ros2::MessageLibrary library;
    return report_of(value_of(read_course(recording_.write(folder_.path() / "bag.mcap"), library)),
                     graph);
  }

  const culprit::test::TestFolder folder_;
  test::Recording recording_;
  std::uint64_t count_ = 0;
};

TEST_F(IncidentTest, TheCauseComesFirstWithItsEffects) {
  topic("/scan");
  topic("/image", 20);
  topic("/detections", 20.15);
  topic("/tracks", 20.2);
  const BagReport found = report(value_of(parse_graph(kGraph)));
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
  EXPECT_THAT(found.incidents[0].effects, ElementsAre("/detector", "/tracker"));
  EXPECT_EQ(found.findings[0].code, "D200");
  EXPECT_THAT(
      found.findings[0].seen,
      AllOf(HasSubstr("it fell silent on /image; then /detector fell silent on /detections")));
  EXPECT_THAT(found.left_out, IsEmpty());
}

TEST_F(IncidentTest, ADiagnosticIsOfTheNodeOfTheGraphThatItNames) {
  topic("/scan");
  topic("/image", 20);
  for (int i = 0; i < 60; ++i)
    recording_.add("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", i + 0.5,
                   test::diagnostic(i, i < 20 ? 0 : 2, "camera: frames", "no frame"));
  const BagReport found = report(value_of(parse_graph(kGraph)));
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
  EXPECT_EQ(node_of_status("camera: frames", {"/r1/camera"}), "/r1/camera");
  EXPECT_EQ(node_of_status("camera: frames", {"/r1/camera", "/r2/camera"}), "");
}

TEST_F(IncidentTest, ANodeOfWhichNothingWasRecordedIsNamedIfAllThatNeedItFailedAtOnce) {
  topic("/scan");
  topic("/detections", 20);
  topic("/tracks", 20.1);
  const BagReport found = report(value_of(parse_graph(kGraph)));
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
  EXPECT_THAT(found.findings[0].seen, HasSubstr("nothing of it was recorded"));
}

TEST_F(IncidentTest, FailuresThatNothingConnectsAreTwoIncidents) {
  topic("/other");
  topic("/scan", 30);
  topic("/image", 20);
  const BagReport found = report(value_of(parse_graph(kGraph)));
  ASSERT_EQ(found.incidents.size(), 2u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
  EXPECT_EQ(found.incidents[1].cause, "/lidar");
}

TEST_F(IncidentTest, AFailureThatWasOverIsNoCauseOfALaterOne) {
  topic("/scan");
  topic("/image", 20);
  topic("/image", 60, 24);
  topic("/detections", 50);
  const BagReport found = report(value_of(parse_graph(kGraph)));
  ASSERT_EQ(found.incidents.size(), 2u);
  EXPECT_THAT(found.incidents[0].effects, IsEmpty());
  EXPECT_THAT(found.incidents[1].effects, IsEmpty());
}

TEST_F(IncidentTest, WithoutAGraphTheMissingEvidenceIsNamed) {
  topic("/scan");
  topic("/image", 20);
  topic("/detections", 20.15);
  const BagReport found = report();
  EXPECT_THAT(
      found.left_out,
      Contains(HasSubstr("does not say which node publishes /detections and /image: add --graph")));
}

TEST_F(IncidentTest, TheGraphMayBeInTheRecording) {
  topic("/scan");
  topic("/image", 20);
  topic("/detections", 20.15);
  recording_.add("/culprit/graph", "std_msgs/msg/String", 0,
                 test::Payload()
                     .put_text(R"({"nodes": [{"name": "/camera", "publishes": ["/image"]},
                                             {"name": "/detector", "subscribes": ["/image"], "publishes": ["/detections"]}]})")
                     .bytes());
  const BagReport found = report();
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
}

TEST_F(IncidentTest, TheGraphMayBeThatOfRosgraphMsgs) {
  topic("/scan");
  topic("/image", 20);
  topic("/detections", 20.15);
  const std::string line(80, '=');
  recording_.define("rosgraph_msgs/msg/Graph", "Node[] nodes\n" + line +
                                                   "\nMSG: rosgraph_msgs/Node\nTopic[] publishers\n"
                                                   "Topic[] subscriptions\nstring name\n" +
                                                   line +
                                                   "\nMSG: rosgraph_msgs/Topic\nstring name\n");
  const auto node = [](test::Payload& payload, const std::string& name, const char* publishes,
                       const char* reads) {
    for (const char* each : {publishes, reads}) {
      payload.put(std::uint32_t{each == nullptr ? 0u : 1u});
      if (each != nullptr) payload.put_text(each);
    }
    payload.put_text(name);
  };
  test::Payload graph;
  graph.put(std::uint32_t{2});
  node(graph, "/camera", "/image", nullptr);
  node(graph, "/detector", "/detections", "/image");
  recording_.add("/graph", "rosgraph_msgs/msg/Graph", 0, graph.bytes());
  const BagReport found = report();
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
}

TEST_F(IncidentTest, RulesDeclareDependencies) {
  topic("/scan");
  topic("/image", 20);
  topic("/detections", 20.15);
  const auto checked = check(Source("r", R"(
COMPONENT camera NODE /camera LAUNCH "c"
COMPONENT detector NODE /detector LAUNCH "d"
DEPENDENCY detector ON camera
RULE A
  POLICIES ERROR
  TRIGGER age(/image FROM camera) > 1s
    STRATEGY s 50 10
      ADAPTATION camera redeploy 1
RULE B
  POLICIES ERROR
  TRIGGER age(/detections) > 1s
    STRATEGY s 50 10
      ADAPTATION detector redeploy 1
)"));
  ASSERT_TRUE(checked.rules);
  const BagReport found = report(graph_of(*checked.rules));
  ASSERT_EQ(found.incidents.size(), 1u);
  EXPECT_EQ(found.incidents[0].cause, "/camera");
  EXPECT_THAT(found.incidents[0].effects, ElementsAre("/detector"));
}

TEST(ParseGraph, RefusesWhatIsNone) {
  for (const char* text : {"", "[]", "{}", R"({"nodes": 3})"})
    EXPECT_FALSE(parse_graph(text)) << text;
}

}  // namespace
}  // namespace culprit::bag_doctor
