// A reader that shares no code with ours: npm's @mcap/core and @foxglove/rosmsg, by which Foxglove reads files. Skipped
// unless `npm ci` was run in peers/mcap.
#include <cstdio>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "recorder/incident_recorder.h"
#include "ros2/message_library.h"
#include "ros2/messages.h"

namespace culprit::recorder {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// What `command` prints.
std::string printed_by(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

template <class Message>
RecordedTopic topic_of_type(const char* name) {
  const std::string type(Message::kType);
  ros2::MessageLibrary library;
  return {name, type, "", ros2::to_text(type, *library.with_parts(type)), {rtps::Qos{}}};
}

struct PeerMcap : testing::Test {
  void SetUp() override {
    if (!std::filesystem::exists(peer / "node_modules"))
      GTEST_SKIP() << "npm ci was not run in " << peer;
    IncidentRecorder recorder({.folder = own.path(), .robot = "robot", .library = "test"});
    const auto log = recorder.add_topic(topic_of_type<ros2::msg::Log>("/rosout"));
    const auto health =
        recorder.add_topic(topic_of_type<ros2::msg::DiagnosticArray>("/diagnostics"));
    const auto odd = recorder.add_topic({"/odd", "my_msgs/msg/Odd", "", {}, {}});
    ros2::msg::Log line;
    line.name = "camera";
    line.msg = "it is dark";
    ros2::msg::DiagnosticArray diagnostics;
    diagnostics.status.resize(1);
    diagnostics.status[0].name = "lens";
    diagnostics.status[0].values = {{"dirt", "0.7"}};
    for (int i = 0; i < 3; ++i) recorder.take({.topic = log, .payload = rtps::encode(line)});
    recorder.take({.topic = health, .payload = rtps::encode(diagnostics)});
    recorder.take({.topic = odd, .payload = {0, 1, 0, 0, 1}});
    recorder.note_event(R"({"type":"strategy_chosen","text":"camera is held responsible"})");
    const auto made = recorder.record_now("a person", std::chrono::seconds(20));
    ASSERT_TRUE(made) << made.error();
    file = *made;
  }
  std::string read(const std::string& how = "") const {
    return printed_by("node " + (peer / "read.mjs").string() + " " + file.string() + " " + how);
  }

  const std::filesystem::path peer = CULPRIT_PEER_MCAP;
  test::TestFolder own;
  std::filesystem::path file;
};

TEST_F(PeerMcap, ReadsARecordingByItsIndex) {
  EXPECT_THAT(
      read(),
      AllOf(
          HasSubstr("metadata rosbag2\n"), HasSubstr("/rosout rcl_interfaces/msg/Log cdr 3 {"),
          HasSubstr(R"("msg":"it is dark")"), HasSubstr("/odd my_msgs/msg/Odd cdr 1 -\n"),
          HasSubstr(R"("name":"lens")"), HasSubstr(R"({"key":"dirt","value":"0.7"})"),
          HasSubstr(
              R"(/culprit/events std_msgs/msg/String cdr 1 {"data":"{\"type\":\"strategy_chosen\")")));
}

TEST_F(PeerMcap, ReadsWhatIsThereOfOneWhoseEndIsMissing) {
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 100);
  EXPECT_THAT(read("--streamed"),
              AllOf(HasSubstr(R"("msg":"it is dark")"), HasSubstr("/culprit/events")));
}

}  // namespace
}  // namespace culprit::recorder
