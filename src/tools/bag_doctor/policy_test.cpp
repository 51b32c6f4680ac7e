#include "bag_doctor/policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"

namespace culprit::bag_doctor {
namespace {

using culprit::test::value_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// /a at 10 Hz for 60 s, with a pause from 20 s to 26 s; /b 30 ms behind each message of /a.
std::vector<std::string> breaches_of(const std::string& policy) {
  const culprit::test::TestFolder folder;
  test::Recording recording;
  for (int i = 0; i <= 600; ++i) {
    const double time = i * 0.1;
    if (time > 20 && time < 26) continue;
    recording.add("/a", "sensor_msgs/msg/Imu", time, test::imu(time, i));
    recording.add("/b", "sensor_msgs/msg/Imu", time + 0.001, test::imu(time + 0.03, i));
  }
  ros2::MessageLibrary library;
  const BagCourse course =
      value_of(read_course(recording.write(folder.path() / "bag.mcap"), library));
  std::vector<std::string> said;
  for (const auto& each : breaches(value_of(parse_policy(policy)), course))
    said.push_back(each.subject + ": " + each.seen);
  return said;
}

TEST(Policy, ThatIsKeptHasNoFinding) {
  EXPECT_THAT(
      breaches_of(
          "# all is well\nTOPIC /a RATE 8..11 GAP 7s COVERAGE 89%\nTOPIC /b RATE 8..  # no most\n"
          "PAIR /a /b OFFSET 31ms\n"),
      IsEmpty());
}

TEST(Policy, NamesEachWishThatIsNotKept) {
  EXPECT_THAT(
      breaches_of(
          "TOPIC /a RATE 9.5..11 GAP 1s COVERAGE 95%\nTOPIC /map\nPAIR /a /b OFFSET 20ms\n"),
      ElementsAre("/a: its rate is 9.02 Hz, and 9.5..11 is required",
                  "/a: it paused for 6 s, and 1 s is allowed", HasSubstr("/a: it covers 90"),
                  "/map: it has no message in this recording",
                  HasSubstr("the nearest message of /b is up to 0.03 s away")));
}

TEST(Policy, SaysWhichLineIsWrong) {
  for (const auto& [text, why] :
       {std::pair("TOPIC /a\nTOPIC scan\n", "line 2: TOPIC needs the full name"),
        {"GAP 1s", "line 1: a line begins with TOPIC or PAIR"},
        {"TOPIC /a RATE fast", "RATE needs numbers"},
        {"TOPIC /a RATE ..", "RATE needs a limit"},
        {"TOPIC /a GAP 5", "GAP needs a duration"},
        {"TOPIC /a COVERAGE 0.9", "COVERAGE needs a share"},
        {"TOPIC /a COVERAGE", "COVERAGE needs a value"},
        {"PAIR /a /b", "PAIR needs two topics"}}) {
    const auto policy = parse_policy(text);
    ASSERT_FALSE(policy) << text;
    EXPECT_THAT(policy.error(), HasSubstr(why));
  }
}

}  // namespace
}  // namespace culprit::bag_doctor
