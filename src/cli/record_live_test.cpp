// The black box as users have it: `culprit run --record` on a node that is killed, and what is in the recording.
#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "base/environment.h"
#include "base/live_clock.h"
#include "base/text_file.h"
#include "json/json.h"
#include "recorder/recording_folder.h"
#include "ros2/messages.h"
#include "rtps/cdr.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

struct HeardMessage {
  std::int64_t at = 0;
  std::string topic;
  std::string text;  // of a std_msgs/msg/String
};

std::vector<HeardMessage> messages_in(const std::filesystem::path& path) {
  std::vector<HeardMessage> all;
  auto file = bag::BagFile::open(path);
  if (!file) return all;
  for (bag::BagMessage message; file->next(message);) {
    const bag::BagTopic& topic = file->contents().topics()[message.topic];
    HeardMessage heard{message.at, topic.name, ""};
    if (topic.type == ros2::msg::String::kType) {
      const auto* begin = reinterpret_cast<const std::uint8_t*>(message.bytes.data());
      if (const auto said = rtps::decode<ros2::msg::String>({begin, message.bytes.size()}))
        heard.text = said->data;
    }
    all.push_back(std::move(heard));
  }
  return all;
}

auto is_of(const char* topic) { return testing::Field(&HeardMessage::topic, topic); }
auto says(const char* text) { return testing::Field(&HeardMessage::text, HasSubstr(text)); }

struct BlackBoxes : testing::Test {
  BlackBoxes() {
    lidar.emplace(world, std::vector<std::string>{"ros2_peer_node", domain, "--active", "/lidar"});
  }

  TestProgram run(std::vector<std::string> more) const {
    std::vector<std::string> all{"culprit", "run", rules, "--settle", "1", "--state-dir", state()};
    all.insert(all.end(), more.begin(), more.end());
    return TestProgram(world, std::move(all));
  }
  std::string state() const { return (world.folder() / "state").string(); }

  // Repeats `culprit record` until a recording contains `topic`: then all topics are received.
  void wait_until_heard(const TestProgram& culprit, const char* topic) const {
    const Time end = live_now() + TestProgram::kPatience;
    while (true) {
      ASSERT_LT(live_now(), end) << culprit.output();
      TestProgram record(world,
                         {"culprit", "record", "--domain", domain, "--json", "--name", "trial"});
      if (record.wait() != 0) continue;
      const auto said = parse_json(record.output());
      const std::string path = said.value("recording", "");
      ASSERT_TRUE(culprit.prints("messages: " + path)) << culprit.output();
      const auto all = messages_in(path);
      if (std::ranges::any_of(all, [&](const auto& each) { return each.topic == topic; })) return;
    }
  }

  std::filesystem::path recording_of(const char* why) const {
    for (const auto& each : recorder::recordings_in(world.folder() / "state" / "recordings")) {
      if (each.path.string().ends_with("_" + std::string(why) + ".mcap")) return each.path;
    }
    return {};
  }

  const TestWorld world;
  const std::string domain = environment("ROS_DOMAIN_ID");
  const std::string rules = world.write(
      "lidar.rules", "ROBOT rover\nCOMPONENT lidar NODE /lidar LAUNCH \"ros2_peer_node " + domain +
                         " --active /lidar\"\n"
                         "RULE LidarDead\n  POLICIES ERROR\n  TRIGGER age(/lidar/value) > 700ms\n"
                         "    STRATEGY lidar_redeploy 90 10\n      ADAPTATION lidar redeploy 5\n");
  std::optional<TestProgram> lidar;
};

TEST_F(BlackBoxes, RecordAnIncidentFromBeforeItBegan) {
  TestProgram culprit = run({"--record", "--record-after", "1s"});
  ASSERT_TRUE(culprit.prints("lidar is there")) << culprit.output();
  wait_until_heard(culprit, "/lidar/value");
  if (HasFatalFailure()) return;
  const std::int64_t killed = wall_now();
  kill(lidar->pid(), SIGKILL);
  ASSERT_TRUE(culprit.prints("_LidarDead.mcap")) << culprit.output();
  const std::filesystem::path path = recording_of("LidarDead");
  const std::vector<HeardMessage> all = messages_in(path);
  const auto is_before = testing::Field(&HeardMessage::at, testing::Lt(killed));
  EXPECT_THAT(all, Contains(AllOf(is_of("/lidar/value"), is_before)));
  EXPECT_THAT(all, Contains(AllOf(is_of("/diagnostics"), is_before)));
  EXPECT_THAT(all, Contains(is_of("/rosout")));
  EXPECT_THAT(all, Contains(AllOf(is_of("/culprit/graph"),
                                  says("\"/lidar/value\":\"std_msgs/msg/Float64\""))));
  EXPECT_THAT(all, Contains(AllOf(is_of("/culprit/events"), says("\"type\":\"failure_detected\""),
                                  says("LidarDead"))));
  EXPECT_THAT(all, Contains(AllOf(is_of("/culprit/events"), says("\"type\":\"strategy_chosen\""),
                                  says("lidar_redeploy"))));
  EXPECT_THAT(all,
              Contains(AllOf(is_of("/culprit/events"), says("\"type\":\"failure_resolved\""))));

  TestProgram replay(world, {"culprit", "replay", path, "--rules", rules});
  EXPECT_EQ(replay.wait(), 0);
  EXPECT_THAT(replay.output(), HasSubstr("LidarDead detected")) << replay.output();
  const std::string other = world.write("new.rules",
                                        "COMPONENT lidar NODE /lidar\nRULE LidarLate\n  POLICIES "
                                        "WARNING REPORT\n  TRIGGER age(/lidar/value) > 300ms\n");
  TestProgram with_others(world, {"culprit", "replay", path, "--rules", other});
  EXPECT_EQ(with_others.wait(), 0);
  EXPECT_THAT(with_others.output(),
              AllOf(HasSubstr("LidarLate detected"), Not(HasSubstr("LidarDead"))))
      << with_others.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
}

// Without a running culprit: from the journal and the recording.
TEST_F(BlackBoxes, BecomeAPageOfTheIncidentThatShowsWhatTheRulesRead) {
  TestProgram culprit = run({"--record", "--record-after", "1s"});
  ASSERT_TRUE(culprit.prints("lidar is there")) << culprit.output();
  wait_until_heard(culprit, "/lidar/value");
  if (HasFatalFailure()) return;
  std::filesystem::remove_all(state() + "/recordings");  // those of the trial, a moment before
  kill(lidar->pid(), SIGKILL);
  ASSERT_TRUE(culprit.prints("_LidarDead.mcap")) << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
  const std::string journal = state() + "/rover.journal";

  TestProgram list(world, {"culprit", "incident", "--journal", journal, "--json"});
  EXPECT_EQ(list.wait(), 0) << list.output();
  const auto all = parse_json(list.output());
  ASSERT_TRUE(all.contains("incidents")) << list.output();
  ASSERT_THAT(all["incidents"], SizeIs(1)) << list.output();
  EXPECT_EQ(all["incidents"][0]["recordings"][0]["path"], recording_of("LidarDead").string());
  const std::string id = all["incidents"][0]["id"];
  TestProgram table(world, {"culprit", "incident", "--journal", journal});
  EXPECT_EQ(table.wait(), 0);
  EXPECT_THAT(table.output(),
              AllOf(HasSubstr(id), HasSubstr("lidar_redeploy"), HasSubstr("_LidarDead.mcap")));

  const std::string file = (world.folder() / "page.html").string();
  TestProgram page(world, {"culprit", "incident", id, "--journal", journal, "-o", file, "--json"});
  EXPECT_EQ(page.wait(), 0) << page.output();
  EXPECT_THAT(page.output(), HasSubstr("\"curves\":[{\"name\":\"time between messages of "
                                       "/lidar/value\",\"about\":\"read by LidarDead\""));
  const auto html = read_text(file);
  ASSERT_TRUE(html) << html.error();
  EXPECT_THAT(*html,
              AllOf(HasSubstr("<h1>lidar, "), HasSubstr("lidar_redeploy"),
                    HasSubstr("<b>time between messages of /lidar/value</b>"),
                    HasSubstr("class=\"mark detected\""), HasSubstr("class=\"mark decided\""),
                    HasSubstr("class=\"mark resolved\""), HasSubstr("A rule's limit is 0.7 s")));

  // Damaged, and gone: the page is made all the same, and says it.
  std::filesystem::resize_file(recording_of("LidarDead"), 1000);
  TestProgram damaged(world, {"culprit", "incident", id, "--journal", journal, "-o", file});
  EXPECT_EQ(damaged.wait(), 0) << damaged.output();
  EXPECT_THAT(damaged.output(), HasSubstr("is not whole"));
  std::filesystem::remove(recording_of("LidarDead"));
  TestProgram gone(world, {"culprit", "incident", id, "--journal", journal});
  EXPECT_EQ(gone.wait(), 0);
  EXPECT_THAT(gone.output(),
              AllOf(HasSubstr("<h1>lidar, "), HasSubstr("There is no recording of it"),
                    Not(HasSubstr("<figure>"))));

  TestProgram unknown(world, {"culprit", "incident", "1", "--journal", journal});
  EXPECT_EQ(unknown.wait(), 1);
  EXPECT_THAT(unknown.output(), HasSubstr("there is no incident '1' in"));
  TestProgram nonsense(world, {"culprit", "incident", "no id", "--journal", journal});
  EXPECT_EQ(nonsense.wait(), 2);
  EXPECT_THAT(nonsense.output(), HasSubstr("culprit incident lists them"));
  TestProgram nowhere(world,
                      {"culprit", "incident", id, "--journal", journal, "-o", "/no/such/folder/x"});
  EXPECT_EQ(nowhere.wait(), 1);
  EXPECT_THAT(nowhere.output(), HasSubstr("/no/such/folder/x"));
}

TEST_F(BlackBoxes, LeaveARecordingThatCanBeReadWhenCulpritIsKilled) {
  TestProgram culprit = run({"--record", "--record-after", "1s"});
  ASSERT_TRUE(culprit.prints("lidar is there")) << culprit.output();
  wait_until_heard(culprit, "/lidar/value");
  if (HasFatalFailure()) return;
  culprit.signal(SIGUSR1);
  std::filesystem::path path;
  for (const Time end = live_now() + TestProgram::kPatience; messages_in(path).empty();
       path = recording_of("SIGUSR1"))
    ASSERT_LT(live_now(), end) << culprit.output();
  culprit.signal(SIGKILL);
  culprit.wait();
  TestProgram replay(world, {"culprit", "replay", path, "--rules", rules});
  replay.wait();
  EXPECT_THAT(replay.output(), AllOf(HasSubstr(" messages"), Not(HasSubstr("\n0 messages"))));
  EXPECT_THAT(messages_in(path), Contains(is_of("/lidar/value")));
}

TEST_F(BlackBoxes, AreNotThereUnlessTheyAreWanted) {
  TestProgram culprit = run({});
  ASSERT_TRUE(culprit.prints("lidar is there")) << culprit.output();
  TestProgram record(world, {"culprit", "record", "--domain", domain});
  EXPECT_EQ(record.wait(), 1);
  EXPECT_THAT(record.output(), HasSubstr("culprit run --record")) << record.output();
  culprit.signal(SIGUSR1);
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0) << culprit.output();
  EXPECT_FALSE(std::filesystem::exists(world.folder() / "state" / "recordings"));
}

}  // namespace
}  // namespace culprit::cli
