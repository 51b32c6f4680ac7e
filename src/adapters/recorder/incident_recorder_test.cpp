#include "recorder/incident_recorder.h"

#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "base/live_clock.h"
#include "base/test_folder.h"
#include "base/text_file.h"
#include "ros2/message_library.h"
#include "ros2/messages.h"

namespace culprit::recorder {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// The messages for people, from the thread of a recorder.
class Said {
 public:
  void add(const std::string& text) {
    const MutexLock lock(mutex_);
    all_.push_back(text);
    changed_.notify_all();
  }
  bool wait_for(std::size_t count) {
    MutexLock lock(mutex_);
    return changed_.wait_for(lock, 20s,
                             [&]() CULPRIT_REQUIRES(mutex_) { return all_.size() >= count; });
  }
  std::vector<std::string> all() {
    const MutexLock lock(mutex_);
    return all_;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<std::string> all_ CULPRIT_GUARDED_BY(mutex_);
};

struct Recorders : testing::Test {
  IncidentRecorder::Options options() {
    return {.folder = own / "recordings",
            .robot = "robot",
            .library = "test",
            .before = 20s,
            .after = 0s,
            .space =
                [](const std::filesystem::path&) {
                  return Expected<RecordingFolder::Space>({1'000'000'000'000, 900'000'000'000});
                },
            .say = [this](const std::string& text) { said.add(text); }};
  }
  std::vector<StoredRecording> recordings() const { return recordings_in(own / "recordings"); }

  test::TestFolder own;
  Said said;
};

RingMessage text(std::size_t topic, const std::string& what) {
  return {.topic = topic, .payload = rtps::encode(ros2::msg::String{what})};
}
RecordedTopic topic_called(const char* name) {
  return {name, "std_msgs/msg/String", "", "string data\n", {rtps::Qos{}}};
}

// Texts by topic, from a recording without other content.
std::multimap<std::string, std::string> texts_in(const std::filesystem::path& path) {
  std::multimap<std::string, std::string> all;
  auto file = bag::BagFile::open(path);
  if (!file) return all;
  for (bag::BagMessage message; file->next(message);) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(message.bytes.data());
    const auto said = rtps::decode<ros2::msg::String>({begin, message.bytes.size()});
    all.emplace(file->contents().topics()[message.topic].name, said ? said->data : "?");
  }
  EXPECT_THAT(file->contents().losses(), IsEmpty());
  return all;
}

TEST_F(Recorders, WriteWhatCameBeforeAndAfterAFailure) {
  IncidentRecorder recorder(options());
  const std::size_t chatter = recorder.add_topic(topic_called("/chatter"));
  recorder.take(text(chatter, "before"));
  recorder.note_event(R"({"type": "failure_detected"})");
  recorder.begin("CameraDead");
  recorder.take(text(chatter, "after"));
  recorder.over();
  ASSERT_TRUE(said.wait_for(1));
  ASSERT_THAT(recordings(), SizeIs(1));
  EXPECT_THAT(recordings()[0].path.filename().string(), HasSubstr("_CameraDead.mcap"));
  EXPECT_THAT(texts_in(recordings()[0].path),
              ElementsAre(std::pair("/chatter", "before"), std::pair("/chatter", "after"),
                          std::pair("/culprit/events", R"({"type": "failure_detected"})")));
}

TEST_F(Recorders, GoOnUntilAllIsWell) {
  IncidentRecorder recorder(options());
  const std::size_t chatter = recorder.add_topic(topic_called("/chatter"));
  recorder.begin("First");
  recorder.begin("Second");
  const auto path = recorder.record_now("a person", 20s);
  ASSERT_TRUE(path) << path.error();
  recorder.take(text(chatter, "late"));
  EXPECT_THAT(said.all(), IsEmpty()) << "it is on";
  recorder.over();
  ASSERT_TRUE(said.wait_for(1));
  EXPECT_THAT(recordings(), SizeIs(1)) << "it is one incident";
  EXPECT_THAT(texts_in(*path), Contains(std::pair("/chatter", "late")));
}

TEST_F(Recorders, EndTheRecordingWithTheRun) {
  {
    IncidentRecorder recorder(options());
    recorder.begin("Dead");
    recorder.note_event("{}");
  }
  ASSERT_THAT(recordings(), SizeIs(1));
  EXPECT_THAT(texts_in(recordings()[0].path), SizeIs(1));
}

TEST_F(Recorders, KnowWhatWasLatchedLongAgo) {
  IncidentRecorder::Options short_memory = options();
  short_memory.before = 0s;
  IncidentRecorder recorder(short_memory);
  const std::size_t map = recorder.add_topic(topic_called("/map"));
  recorder.take_latched(text(map, "walls"), {}, Share::kSmall);
  recorder.note_graph(R"({"nodes": []})");
  const auto path = recorder.record_now("a person", 20s);
  ASSERT_TRUE(path) << path.error();
  ASSERT_TRUE(said.wait_for(1));
  EXPECT_THAT(texts_in(*path), ElementsAre(std::pair("/culprit/graph", R"({"nodes": []})"),
                                           std::pair("/map", "walls")));
}

TEST_F(Recorders, KeepWhatATypeLooksLikeAndMessagesOfWhichNobodyKnows) {
  std::filesystem::path path;
  {
    IncidentRecorder recorder(options());
    const auto known =
        recorder.add_topic({"/pose",
                            "my_msgs/msg/Pose",
                            "",
                            "float64 x\nmy_msgs/Frame frame\n" + std::string(80, '=') +
                                "\nMSG: my_msgs/Frame\nstring name\n",
                            {}});
    const auto unknown = recorder.add_topic({"/odd", "my_msgs/msg/Odd", "", {}, {}});
    recorder.take({.topic = known, .payload = {0, 1, 0, 0}});
    recorder.take({.topic = unknown, .payload = {0, 1, 0, 0, 7}});
    path = *recorder.record_now("a person", 20s);
  }
  auto file = bag::BagFile::open(path);
  ASSERT_TRUE(file) << file.error();
  int messages = 0;
  for (bag::BagMessage message; file->next(message);) ++messages;
  EXPECT_EQ(messages, 2);
  const bag::BagContents& contents = file->contents();
  EXPECT_EQ(contents.topics()[1].type, "my_msgs/msg/Odd");
  ros2::MessageLibrary library;
  ASSERT_NE(contents.definition_of("my_msgs/msg/Pose"), nullptr);
  library.learn("my_msgs/msg/Pose", *contents.definition_of("my_msgs/msg/Pose"));
  EXPECT_EQ(library.with_parts("my_msgs/msg/Pose")->size(), 2);
}

TEST_F(Recorders, KnowNoMoreTopicsThanTheyMay) {
  IncidentRecorder recorder(options());
  std::size_t last = 0;
  for (std::size_t i = 0; i <= IncidentRecorder::kMostTopics; ++i)
    last = recorder.add_topic(topic_called(("/t" + std::to_string(i)).c_str()));
  EXPECT_EQ(last, IncidentRecorder::kNoTopic);
  recorder.take(text(last, "of nobody"));
  recorder.take_latched(text(last, "of nobody"), {}, Share::kSmall);
  const auto path = recorder.record_now("a person", 20s);
  ASSERT_TRUE(path) << path.error();
  ASSERT_TRUE(said.wait_for(1));
  EXPECT_THAT(texts_in(*path), IsEmpty());
}

TEST_F(Recorders, SayOnceThatTheFolderIsLostAndTryAgain) {
  ASSERT_TRUE(write_text(own / "recordings", "a file is in the way"));
  IncidentRecorder recorder(options());
  recorder.note_event("{}");
  EXPECT_FALSE(recorder.record_now("first", 20s));
  const auto again = recorder.record_now("second", 20s);
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error(), HasSubstr("recordings cannot be made"));
  EXPECT_THAT(said.all(), SizeIs(1));
  std::filesystem::remove(own / "recordings");
  EXPECT_TRUE(recorder.record_now("third", 20s));
}

TEST_F(Recorders, WriteNothingWhereTheDiskIsNearlyFull) {
  IncidentRecorder::Options full = options();
  full.space = [](const std::filesystem::path&) {
    return Expected<RecordingFolder::Space>({10'000'000'000, 1'000'000'100});
  };
  IncidentRecorder recorder(full);
  const auto path = recorder.record_now("a person", 20s);
  ASSERT_FALSE(path);
  EXPECT_THAT(path.error(), HasSubstr("stay free"));
  EXPECT_THAT(recordings(), IsEmpty());
}

// The disk is full before anybody could know: a file may have 300 kB, in a process of its own.
TEST_F(Recorders, LeaveAFileThatCanBeReadWhenTheDiskIsFull) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    constexpr rlimit kSmall{300'000, 300'000};
    setrlimit(RLIMIT_FSIZE, &kSmall);
    bool is_right = false;
    {
      IncidentRecorder recorder(options());
      const std::size_t noise = recorder.add_topic(topic_called("/noise"));
      recorder.begin("Dead");
      unsigned random = 1;
      for (int i = 0; i < 200; ++i) {
        RingMessage message{.topic = noise, .payload = rtps::Bytes(20'000)};
        for (auto& byte : message.payload)
          byte = static_cast<std::uint8_t>((random = random * 1664525 + 1013904223) >> 24);
        recorder.take(std::move(message));
        if (i == 5 && !recorder.record_now("meanwhile", 20s)) _exit(2);
      }
      is_right = said.wait_for(1);
    }
    const std::vector<std::string> all = said.all();
    _exit(is_right && all.size() == 1 && all[0].find("ends early") != std::string::npos ? 0 : 3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  ASSERT_THAT(recordings(), SizeIs(1));
  EXPECT_LE(recordings()[0].bytes, 300'000);
  auto file = bag::BagFile::open(recordings()[0].path);
  ASSERT_TRUE(file) << file.error();
  int messages = 0;
  for (bag::BagMessage message; file->next(message);) ++messages;
  EXPECT_GE(messages, 6) << "what was written before";
}

// The manager relies on it: a slow disk delays no caller.
TEST_F(Recorders, HoldNobodyUpWhileTheDiskDoesNotAnswer) {
  Mutex mutex;
  ConditionVariable changed;
  bool answers = false;
  bool is_asked = false;
  IncidentRecorder::Options slow = options();
  slow.memory = 10'000'000;
  slow.space = [&](const std::filesystem::path&) {
    MutexLock lock(mutex);
    is_asked = true;
    changed.notify_all();
    changed.wait(lock, [&] { return answers; });
    return Expected<RecordingFolder::Space>({1'000'000'000'000, 900'000'000'000});
  };
  {
    IncidentRecorder recorder(slow);
    const std::size_t chatter = recorder.add_topic(topic_called("/chatter"));
    recorder.begin("Dead");
    {
      MutexLock lock(mutex);
      changed.wait(lock, [&] { return is_asked; });
    }
    // All of this returns though the disk has not: a deadlock would be the failure.
    for (int i = 0; i < 100'000; ++i) recorder.take(text(chatter, std::string(200, 'x')));
    recorder.begin("Another");
    recorder.note_event("{}");
    recorder.over();
    EXPECT_THAT(recordings(), IsEmpty());
    const MutexLock lock(mutex);
    answers = true;
    changed.notify_all();
  }
  EXPECT_THAT(recordings(), SizeIs(1));
}

TEST(OfferedQos, IsWrittenAsRosbag2ReadsIt) {
  rtps::Qos latched;
  latched.durability = rtps::Durability::kTransientLocal;
  EXPECT_EQ(
      offered_qos_profiles({latched}),
      "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 1\n"
      "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
      "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
      "  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
      "  avoid_ros_namespace_conventions: false\n");
}

}  // namespace
}  // namespace culprit::recorder
