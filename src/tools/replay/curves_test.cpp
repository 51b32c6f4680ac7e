// Curves of a journal: each second, over all runs, with holes where nobody looked.
#include "replay/curves.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "replay/test_life.h"

namespace culprit::replay {
namespace {

using test::kWall;
using test::Life;
using test::TestRobot;
using test::value_of;
using namespace std::chrono_literals;
using culprit::test::TestFolder;

constexpr const char* kCurveRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
SIGNAL brightness TOPIC /brightness FIELD data
RULE Dark
  POLICIES ERROR
  TRIGGER brightness < 10 || age(/rgb) > 60s
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 3
)";

std::int64_t wall_at(Duration since_start) { return kWall + since_start.count(); }

// Five minutes of a camera at 10 Hz, dark for a second in the third one.
void record_camera(const std::filesystem::path& path) {
  TestRobot robot(kCurveRules);
  robot.add("camera", {}, "/rgb");
  Life life(path, robot, kCurveRules);
  robot.discover();
  robot.signal("brightness", Value(50.0), 150s);
  robot.signal("brightness", Value(20.0), 1s);
  robot.signal("brightness", Value(50.0), 149s);
  life.end(journal::Ending::kStopped);
}

TEST(Curves, AreWhatTheRulesReadThen) {
  const TestFolder folder;
  record_camera(folder / "a.journal");
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  const auto curves = value_of(curves_of(
      reader, {{"rate /rgb", "input brightness", "input nothing"}, wall_at(140s), wall_at(160s)}));
  ASSERT_THAT(curves.clocks.size(), testing::AllOf(testing::Ge(19u), testing::Le(21u)));
  EXPECT_NEAR(curves.clocks.front(), 1e-9 * static_cast<double>(wall_at(140s)), 1.1);
  for (const float rate : curves.columns[0]) EXPECT_NEAR(rate, 10, 1) << "known from the beginning";
  EXPECT_EQ(*std::ranges::min_element(curves.columns[1]), 20);
  EXPECT_EQ(*std::ranges::max_element(curves.columns[1]), 50);
  for (const float value : curves.columns[2]) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(value_of(oldest_curve(reader)).has_value(), true);
}

TEST(Curves, LoseNoPeakWhenTheyAreThinned) {
  const TestFolder folder;
  record_camera(folder / "a.journal");
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  const auto curves = value_of(curves_of(
      reader,
      {.names = {"input brightness"}, .since = wall_at(0s), .until = wall_at(300s), .most = 20}));
  EXPECT_EQ(curves.clocks.size(), 20u);
  EXPECT_EQ(std::ranges::count(curves.columns[0], 20.0F), 1);
}

TEST(Curves, SayThatNothingIsRecordedOfThatTime) {
  const TestFolder folder;
  record_camera(folder / "a.journal");
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  const auto curves = value_of(curves_of(reader, {{"rate /rgb"}, wall_at(4000s), wall_at(5000s)}));
  EXPECT_TRUE(curves.clocks.empty());
  EXPECT_FALSE(curves_of(reader, {{"rate /rgb"}, wall_at(-500s), wall_at(-400s)}));
}

}  // namespace
}  // namespace culprit::replay
