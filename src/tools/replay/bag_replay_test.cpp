// Rules on recordings: each is judged, or the reason is named.
#include "replay/bag_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/test_bag.h"
#include "bag/test_mcap.h"
#include "knowledge/event_words.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/messages.h"

namespace culprit::replay {
namespace {

using bag::test::BagTest;
using bag::test::kBagStart;
using bag::test::kMillisecond;
using bag::test::number;
using bag::test::regular_recording;
using bag::test::TestRecording;
using bag::test::text_of;
using bag::test::value_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr const char* kBig = R"(
SIGNAL x TOPIC /x FIELD data
RULE Big
  POLICIES WARNING REPORT
  TRIGGER x > 40
)";
constexpr const char* kSilent = R"(
RULE Silent
  POLICIES WARNING REPORT
  TRIGGER age(/x) > 500ms
)";

struct Judged {
  std::vector<RuleOutcome> outcomes;
  std::vector<std::string> labels;     // of events
  std::vector<std::string> undecoded;  // topics
  std::vector<std::pair<double, double>> holes;
  double first = -1;  // of the first rule, s from the beginning
};

double after_start(Time at) { return seconds(at - Time(Duration(kBagStart))); }

Judged judge(const fs::path& path, const std::string& rules, BagStretch stretch = {},
             std::vector<fs::path> message_path = {}) {
  const auto checked = check(Source("t", rules));
  EXPECT_TRUE(checked.rules);
  ros2::MessageLibrary library(std::move(message_path));
  bag::BagFile file = value_of(bag::BagFile::open(path));
  bag::BagReading reading(*checked.rules, file.contents(), library);
  Judged judged;
  BagReplay::Listener listener;
  listener.on_event = [&](const Event& event, std::int64_t) {
    judged.labels.emplace_back(words_of(event).label);
  };
  listener.on_hole = [&](Time from, Time until, std::int64_t) {
    judged.holes.emplace_back(after_start(from), after_start(until));
  };
  BagReplay replay(*checked.rules, std::make_unique<BayesPlanner>(), reading, listener, stretch);
  for (bag::BagMessage message; file.next(message);) replay.step(message);
  judged.outcomes = replay.outcomes();
  judged.undecoded = reading.undecoded();
  if (const auto& first = judged.outcomes[0].first) judged.first = after_start(*first);
  return judged;
}

class BagReplayTest : public BagTest {
 protected:
  fs::path written(const TestRecording& recording) {
    fs::remove(folder_ / "a.db3");
    bag::test::write_db3(folder_ / "a.db3", recording);
    return folder_ / "a.db3";
  }
};

// /x without what came from the one time until the other, in seconds.
TestRecording with_silence(double from, double until) {
  TestRecording all = regular_recording();
  std::erase_if(all.messages, [&](const bag::test::TestMessage& each) {
    const double at = static_cast<double>(each.at - kBagStart) / 1e9;
    return at >= from && at < until;
  });
  return all;
}

TEST_F(BagReplayTest, CountsHowOftenAndHowLongARuleFired) {
  const Judged judged = judge(written(with_silence(10, 15)), kSilent);
  const RuleOutcome& silent = judged.outcomes[0];
  EXPECT_EQ(silent.times, 1u);
  EXPECT_NEAR(judged.first, 10.4, 0.01);
  EXPECT_NEAR(seconds(silent.total), 4.8, 0.01) << "as 'cleared after 4.80 s' says";
  EXPECT_EQ(silent.longest, silent.total);
  EXPECT_EQ(*silent.first_clock, kBagStart + 10'400'000'001);
  EXPECT_FALSE(silent.is_on);
  EXPECT_THAT(judged.labels, ElementsAre("detected", "incident", "resolved", "incident"))
      << "nothing is exhausted";
}

TEST_F(BagReplayTest, AFailureThatClearedJustBeforeTheEndIsNotThereAtTheEnd) {
  TestRecording recording = with_silence(10, 15);
  std::erase_if(recording.messages, [](const bag::test::TestMessage& each) {
    return each.at > kBagStart + 15'100 * kMillisecond;
  });
  const RuleOutcome silent = judge(written(recording), kSilent).outcomes[0];
  EXPECT_FALSE(silent.is_on);
  EXPECT_NEAR(seconds(silent.total), 4.6, 0.001);
}

TEST_F(BagReplayTest, SaysThatARuleWasNeverTrue) {
  const Judged judged = judge(written(regular_recording()), kSilent);
  EXPECT_EQ(judged.outcomes[0].times, 0u);
  EXPECT_TRUE(judged.outcomes[0].was_known);
  EXPECT_THAT(judged.outcomes[0].why_unknown, IsEmpty());
}

TEST_F(BagReplayTest, AStretchCountsOnlyWhatIsInIt) {
  const fs::path path = written(with_silence(10, 15));
  const Judged after = judge(path, kSilent, {Time(Duration(kBagStart + 20'000 * kMillisecond))});
  EXPECT_EQ(after.outcomes[0].times, 0u);
  EXPECT_THAT(after.labels, IsEmpty());
  const Judged within = judge(path, kSilent, {Time(Duration(kBagStart + 12'000 * kMillisecond))});
  EXPECT_NEAR(seconds(within.outcomes[0].total), 3.2, 0.05);
}

TEST_F(BagReplayTest, NamesWhatTheRecordingDoesNotHave) {
  TestRecording recording = regular_recording("/other");
  recording.types.emplace_back("/x", "std_msgs/msg/Float64");
  recording.types.emplace_back("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray");
  const Judged judged = judge(written(recording), R"(
COMPONENT ghost NODE /ghost
SIGNAL rpm DIAGNOSTIC "lidar: status" KEY rpm
SIGNAL x TOPIC /x FIELD data
RULE Age
  POLICIES ERROR REPORT
  TRIGGER age(/x) > 2s
RULE Rate
  POLICIES ERROR REPORT
  TRIGGER rate(/x) < 5
RULE Field
  POLICIES ERROR REPORT
  TRIGGER x > 40
RULE Slip
  POLICIES ERROR REPORT
  TRIGGER age(/othr) > 2s
RULE Level
  POLICIES ERROR REPORT
  TRIGGER level("lidar: status") >= 2
RULE Key
  POLICIES ERROR REPORT
  TRIGGER rpm < 100
RULE Ghost
  POLICIES ERROR REPORT
  TRIGGER !alive(ghost)
RULE State
  POLICIES ERROR REPORT
  TRIGGER lifecycle(ghost) != "active"
RULE Param
  POLICIES ERROR REPORT
  TRIGGER parameter(ghost, gain) > 3
RULE Cpu
  POLICIES ERROR REPORT
  TRIGGER cpu(ghost) > 3
RULE Loss
  POLICIES ERROR REPORT
  TRIGGER loss(/other) > 0.5
)");
  const char* const why[] = {"/x was announced, but no message",
                             "/x was announced, but no message",
                             "/x was announced, but no message",
                             "did you mean /other?",
                             "no diagnostics were recorded",
                             "no diagnostics were recorded",
                             "nothing was recorded of node /ghost",
                             "nothing was recorded of node /ghost",
                             "nothing was recorded of node /ghost",
                             "what processes use",
                             "which messages were lost"};
  ASSERT_EQ(judged.outcomes.size(), std::size(why));
  for (std::size_t r = 0; r < std::size(why); ++r) {
    EXPECT_FALSE(judged.outcomes[r].was_known) << r;
    EXPECT_EQ(judged.outcomes[r].times, 0u) << r;
    EXPECT_THAT(judged.outcomes[r].why_unknown, ElementsAre(HasSubstr(why[r]))) << r;
  }
}

TEST_F(BagReplayTest, NamesStatusesKeysAndParametersThatAreNotThere) {
  TestRecording recording{{{"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"},
                           {"/parameter_events", "rcl_interfaces/msg/ParameterEvent"}},
                          {}};
  ros2::msg::DiagnosticArray array;
  array.status.resize(1);
  array.status[0].name = "lidar: status";
  array.status[0].values = {{"temperature", "warm"}};
  ros2::msg::ParameterEvent event;
  event.node = "/camera";
  for (int i = 0; i < 50; ++i) {
    const std::int64_t at = kBagStart + i * 100 * kMillisecond;
    recording.messages.push_back({at, "/diagnostics", std::string(text_of(rtps::encode(array)))});
    recording.messages.push_back(
        {at, "/parameter_events", std::string(text_of(rtps::encode(event)))});
  }
  const Judged judged = judge(written(recording), R"(
COMPONENT camera NODE /camera
SIGNAL rpm DIAGNOSTIC "lidar: status" KEY rpm
SIGNAL heat DIAGNOSTIC "lidar: status" KEY temperature
RULE Level
  POLICIES ERROR REPORT
  TRIGGER level("lidar: statu") >= 2
RULE Key
  POLICIES ERROR REPORT
  TRIGGER rpm < 100
RULE Text
  POLICIES ERROR REPORT
  TRIGGER heat > 3
RULE Param
  POLICIES ERROR REPORT
  TRIGGER parameter(camera, gain) > 3
RULE State
  POLICIES ERROR REPORT
  TRIGGER lifecycle(camera) != "active"
RULE Fine
  POLICIES ERROR REPORT
  TRIGGER level("lidar: status") >= 2
)");
  const char* const why[] = {"did you mean 'lidar: status'?", "no key 'rpm'",
                             "values such as \"warm\"", "no value of parameter gain",
                             "no transition of camera"};
  for (std::size_t r = 0; r < std::size(why); ++r) {
    EXPECT_FALSE(judged.outcomes[r].was_known) << r;
    EXPECT_THAT(judged.outcomes[r].why_unknown, ElementsAre(HasSubstr(why[r]))) << r;
  }
  EXPECT_TRUE(judged.outcomes[5].was_known);
}

TEST_F(BagReplayTest, ANumberThatIsComparedWithATextIsNamed) {
  const Judged judged = judge(written(regular_recording()), R"(
SIGNAL x TOPIC /x FIELD data
RULE Mode
  POLICIES ERROR REPORT
  TRIGGER x == "AUTO"
)");
  EXPECT_FALSE(judged.outcomes[0].was_known);
  EXPECT_THAT(judged.outcomes[0].why_unknown, ElementsAre(HasSubstr("compares it with a text")));
}

TEST_F(BagReplayTest, AMessageThatIsCutMakesItsValueUnknown) {
  TestRecording recording = regular_recording();
  for (std::size_t m = 100; m < 150; ++m) recording.messages[m].bytes.resize(6);
  const Judged judged = judge(written(recording), kBig);
  EXPECT_THAT(judged.undecoded,
              ElementsAre(HasSubstr("50 of 300 messages of /x cannot be decoded")));
  EXPECT_NEAR(seconds(judged.outcomes[0].known), 24.9, 0.1);
  // At 9.1 s it fired for 0.9 s at least; at 4.1, 19.1 and 24.1 s for 1.1 s, and at 29.1 s until the end.
  EXPECT_NEAR(seconds(judged.outcomes[0].longest), 1.1, 0.01);
  EXPECT_NEAR(seconds(judged.outcomes[0].total), 5.0, 0.01);
}

TEST_F(BagReplayTest, LinesOfALogAreCounted) {
  constexpr const char* kErrors =
      "COMPONENT camera NODE /arm/camera\nRULE Errors\n  POLICIES ERROR REPORT\n"
      "  TRIGGER logs(camera, ERROR, 5s) >= 3\n";
  TestRecording recording = regular_recording();
  EXPECT_THAT(judge(written(recording), kErrors).outcomes[0].why_unknown,
              ElementsAre("logs(camera, ERROR, 5s): no log (/rosout) was recorded"));
  recording.types.emplace_back("/rosout", "rcl_interfaces/msg/Log");
  for (int i = 0; i < 30; ++i) {
    ros2::msg::Log line;
    line.level = i >= 12 && i < 16 ? 40 : 30;
    line.name = i % 2 == 0 ? "arm.camera" : "arm.camera.driver";
    recording.messages.push_back(
        {kBagStart + i * 1000 * kMillisecond, "/rosout", std::string(text_of(rtps::encode(line)))});
  }
  const Judged judged = judge(written(recording), kErrors);
  EXPECT_EQ(judged.outcomes[0].times, 1u);
  EXPECT_NEAR(judged.first, 14, 0.01);
  EXPECT_NEAR(seconds(judged.outcomes[0].longest), 4.2, 0.01);
}

TEST_F(BagReplayTest, TextsThatCannotBeComparedAreNamed) {
  TestRecording recording{{{"/s", "std_msgs/msg/String"}}, {}};
  for (int i = 0; i < 100; ++i) {
    ros2::msg::String text;
    text.data = i < 50 ? "12" : "off";
    recording.messages.push_back(
        {kBagStart + i * 100 * kMillisecond, "/s", std::string(text_of(rtps::encode(text)))});
  }
  const Judged judged = judge(written(recording),
                              "SIGNAL s TOPIC /s FIELD data\nRULE High\n  POLICIES ERROR REPORT\n"
                              "  TRIGGER s > 20\n");
  EXPECT_EQ(judged.outcomes[0].times, 0u);
  EXPECT_THAT(judged.outcomes[0].why_unknown,
              ElementsAre(HasSubstr("s also has values such as \"off\"")));
}

TEST_F(BagReplayTest, XcdrTwoIsRead) {
  TestRecording recording = regular_recording();
  const Judged xcdr1 = judge(written(recording), kBig);
  for (auto& each : recording.messages) each.bytes[1] = 0x07;
  const Judged xcdr2 = judge(written(recording), kBig);
  EXPECT_THAT(xcdr2.undecoded, IsEmpty());
  EXPECT_EQ(xcdr2.outcomes[0].times, xcdr1.outcomes[0].times);
}

TEST_F(BagReplayTest, DefinitionsThatDoNotFitAreNamed) {
  TestRecording longer = regular_recording();
  for (auto& each : longer.messages) each.bytes += std::string(8, '\0');
  const Judged unfit = judge(written(longer), kBig);
  EXPECT_THAT(unfit.undecoded, ElementsAre(HasSubstr("do not fit the definition")));
  EXPECT_FALSE(unfit.outcomes[0].was_known);
}

TEST_F(BagReplayTest, ATypeThatChangesIsDecodedByItsOwnChannel) {
  using namespace bag::test;
  std::string data = schema(1, "std_msgs/msg/Float64", "float64 data") + channel(1, 1, "/x") +
                     schema(2, "std_msgs/msg/Float32", "float32 data") + channel(2, 2, "/x");
  for (int i = 0; i < 300; ++i) {
    const auto at = static_cast<std::uint64_t>(kBagStart + i * 100 * kMillisecond);
    const float small = static_cast<float>(i % 50);
    std::string bytes("\0\1\0\0", 4);
    bytes.append(reinterpret_cast<const char*>(&small), sizeof small);
    data += i < 120 ? message(1, at, text_of(number(i % 50))) : message(2, at, bytes);
  }
  const Judged judged = judge(write("a.mcap", mcap(data, 300)), kBig);
  EXPECT_EQ(judged.outcomes[0].times, 6u);
  EXPECT_THAT(judged.undecoded, IsEmpty());
  EXPECT_NEAR(seconds(judged.outcomes[0].known), 29.9, 0.1);
}

TEST_F(BagReplayTest, AHoleOfTheCopyIsNoSilenceOfTheRobot) {
  const TestRecording whole = regular_recording();
  const auto part = [&](std::size_t from, std::size_t until) {
    TestRecording some = whole;
    some.messages.assign(whole.messages.begin() + static_cast<std::ptrdiff_t>(from),
                         whole.messages.begin() + static_cast<std::ptrdiff_t>(until));
    return some;
  };
  bag::test::write_db3(folder_ / "b_0.db3", part(0, 100));
  bag::test::write_db3(folder_ / "b_2.db3", part(200, 300));
  bag::test::write_metadata(folder_, {"b_0.db3", "b_1.db3", "b_2.db3"}, 300);
  const Judged judged = judge(folder_, kSilent);
  EXPECT_EQ(judged.outcomes[0].times, 0u);
  ASSERT_EQ(judged.holes.size(), 1u);
  EXPECT_NEAR(judged.holes[0].first, 9.9, 1e-6);
  EXPECT_NEAR(judged.holes[0].second, 20.0, 1e-6);
  EXPECT_NEAR(seconds(judged.outcomes[0].known), 19.8, 0.2);
}

// Recorders write the text of the .srv or .action file for the types that are made of its parts.
TEST_F(BagReplayTest, ReadsServiceEventsByTheTextOfTheirService) {
  using namespace bag::test;
  std::string data =
      schema(1, "example_interfaces/srv/AddTwoInts_Event", "int64 a\nint64 b\n---\nint64 sum\n") +
      channel(1, 1, "/add/_service_event");
  for (int i = 0; i < 10; ++i) {
    // info (type, stamp, client, sequence number), one request, no response
    std::string bytes("\0\1\0\0", 4);
    bytes += little(1, 4) + little(1'700'000'000, 4) + little(0, 4) + std::string(16, '\0') +
             little(0, 4) + little(static_cast<std::uint64_t>(i), 8) + little(1, 4) + little(0, 4) +
             little(static_cast<std::uint64_t>(i), 8) + little(2, 8) + little(0, 4);
    data += message(1, static_cast<std::uint64_t>(kBagStart + i * 1000 * kMillisecond), bytes);
  }
  const Judged judged = judge(write("a.mcap", mcap(data, 10)), R"(
SIGNAL a TOPIC /add/_service_event FIELD request[0].a
RULE A
  POLICIES WARNING REPORT
  TRIGGER a > 5
)");
  EXPECT_THAT(judged.undecoded, IsEmpty());
  EXPECT_NEAR(judged.first, 6.0, 0.01);
}

TEST_F(BagReplayTest, ReadsFeedbackByTheTextOfItsAction) {
  using namespace bag::test;
  std::string data = schema(1, "my_msgs/action/Go_FeedbackMessage",
                            "float64 goal\n---\nbool done\n---\nfloat64 left\n") +
                     channel(1, 1, "/go/_action/feedback");
  for (int i = 0; i < 10; ++i) {
    const std::string bytes = std::string("\0\1\0\0", 4) + std::string(16, '\0') +
                              std::string(text_of(number(i))).substr(4);
    data += message(1, static_cast<std::uint64_t>(kBagStart + i * 1000 * kMillisecond), bytes);
  }
  const Judged judged = judge(write("a.mcap", mcap(data, 10)), R"(
SIGNAL left TOPIC /go/_action/feedback FIELD feedback.left
RULE Far
  POLICIES WARNING REPORT
  TRIGGER left > 5
)");
  EXPECT_NEAR(judged.first, 6.0, 0.01);
}

}  // namespace
}  // namespace culprit::replay
