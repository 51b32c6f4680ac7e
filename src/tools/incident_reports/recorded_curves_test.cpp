// The curves from a recording of an incident: their selection, and arbitrary bytes.
#include "incident_reports/recorded_curves.h"

#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/test_bag.h"
#include "bag/test_mcap.h"
#include "base/test_expected.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "ros2/messages.h"

namespace culprit::incident_reports {
namespace {

using bag::test::channel;
using bag::test::chunk;
using bag::test::mcap;
using bag::test::message;
using bag::test::schema;
using culprit::test::value_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Le;
using testing::Not;
using testing::SizeIs;

constexpr std::int64_t kSecondInNanoseconds = 1'000'000'000;
constexpr std::int64_t kStart = 1'800'000'000 * kSecondInNanoseconds;

const RuleSet& rules_of_rover() {
  static const RuleSet rules = *check(Source("rover.rules", R"(
ROBOT rover
COMPONENT drive NODE /drive
COMPONENT lidar NODE /lidar
SIGNAL speed TOPIC /speed FIELD data
SIGNAL load DIAGNOSTIC board KEY load
RULE TooFast
  POLICIES ERROR
  TRIGGER speed > 2.5 || age(/scan) > 500ms || mean(load, 2s) > 0.5
    STRATEGY again 50 10
      ADAPTATION drive restart 3
RULE Overheated
  POLICIES ERROR
  TRIGGER load > 0.9
    STRATEGY pause 50 10
      ADAPTATION lidar restart 3
)"))
                                    .rules;
  return rules;
}

std::string words_of(const rtps::Bytes& bytes) { return std::string(bag::test::text_of(bytes)); }
std::string wheels(double left, std::int32_t gear) {
  rtps::CdrWriter writer;
  writer(left, gear);
  return words_of(writer.take());
}

constexpr const char* kRoverGraph =
    R"({"nodes":[{"name":"/drive","publishes":{"/wheels":"a/msg/Wheels","/speed":"std_msgs/msg/Float64",
"/rosout":"rcl_interfaces/msg/Log"},"subscribes":{"/goal":"std_msgs/msg/Float64"}},
{"name":"/lidar","publishes":{"/scan":"a/msg/Scan"}},{"name":"/other","publishes":{"/unrelated":"std_msgs/msg/Float64"}}]})";

// Ten seconds of a robot: it drives faster and faster, once much too fast, and its lidar falls silent after six.
struct RoverRecording {
  std::string graph = kRoverGraph;

  std::string data() const {
    std::string all = schema(1, "std_msgs/msg/Float64", "float64 data\n") +
                      schema(2, "std_msgs/msg/String", "string data\n") +
                      schema(3, "a/msg/Wheels", "float64 left\nint32 gear\n") +
                      schema(4, "a/msg/Scan", "uint8[] ranges\n") + channel(1, 1, "/speed") +
                      channel(2, 2, "/culprit/graph") + channel(3, 3, "/wheels") +
                      channel(4, 4, "/scan") + channel(5, 1, "/unrelated") + channel(6, 1, "/goal");
    all += message(2, kStart, words_of(rtps::encode(ros2::msg::String{graph})));
    for (int i = 0; i <= 100; ++i) {
      const std::int64_t at = kStart + i * kSecondInNanoseconds / 10;
      const double speed = i == 77 ? 9 : 0.01 * i;
      all += message(1, at, words_of(bag::test::number(speed)));
      all += message(3, at, wheels(2 * speed, 1));
      if (i <= 60) all += message(4, at, std::string("\0\1\0\0\0\0\0\0", 8));
      all += message(5, at, words_of(bag::test::number(i)));
      if (i % 20 == 0) all += message(6, at, words_of(bag::test::number(i / 20)));
    }
    return all;
  }
  std::string bytes() const { return mcap(chunk(data(), "zstd"), 0); }
};

struct RecordedIncident : testing::Test {
  std::filesystem::path write(const std::string& bytes) const {
    const auto path = folder / "rover_20261125T190317.042Z_TooFast.mcap";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  Expected<RecordedCurves> curves(const std::string& bytes, const CurveLimits& limits = {}) const {
    return recorded_curves(write(bytes), {rules_of_rover(), {"TooFast"}, {"drive"}}, limits);
  }
  static std::vector<std::string> names(const RecordedCurves& shown) {
    std::vector<std::string> all;
    for (const Curve& each : shown.curves) all.push_back(each.name);
    return all;
  }

  const culprit::test::TestFolder folder;
};

TEST_F(RecordedIncident, ShowsWhatTheFailedRuleReadsAndThenWhatTheComponentSaysAndHears) {
  const RecordedCurves shown = value_of(curves(RoverRecording().bytes()));
  EXPECT_THAT(names(shown), ElementsAre("speed (/speed data)", "time between messages of /scan",
                                        "/wheels left", "/goal data"));
  EXPECT_EQ(shown.begin, kStart);
  EXPECT_EQ(shown.end, kStart + 10 * kSecondInNanoseconds);
  const Curve& speed = shown.curves[0];
  EXPECT_EQ(speed.about, "read by TooFast");
  EXPECT_THAT(speed.limits, ElementsAre(2.5));
  EXPECT_THAT(speed.points, SizeIs(101));
  EXPECT_THAT(speed.points,
              Contains(bag::ThinnedCurve::Point{kStart + 77 * kSecondInNanoseconds / 10, 9}));
  EXPECT_EQ(shown.curves[2].about, "drive publishes it");
  EXPECT_EQ(shown.curves[3].about, "drive subscribes to it");
  EXPECT_THAT(shown.remarks,
              ElementsAre("The recording has nothing of what these rules read: load."));
}

TEST_F(RecordedIncident, ShowsASilenceThatHasNotEnded) {
  const RecordedCurves shown = value_of(curves(RoverRecording().bytes()));
  const Curve& scan = shown.curves[1];
  EXPECT_EQ(scan.unit, "s");
  EXPECT_THAT(scan.limits, ElementsAre(0.5));
  EXPECT_NEAR(scan.points.front().value, 0.1, 1e-6);
  EXPECT_EQ(scan.points.back().at, shown.end);
  EXPECT_NEAR(scan.points.back().value, 4, 1e-6);
}

TEST_F(RecordedIncident, ShowsTheRhythmOfPicturesThatHaveNoNumbers) {
  const RecordedCurves shown = value_of(recorded_curves(
      write(RoverRecording().bytes()), {rules_of_rover(), {}, {"lidar", "nobody"}}));
  ASSERT_THAT(names(shown), ElementsAre("time between messages of /scan"));
  EXPECT_EQ(shown.curves[0].about, "lidar publishes it");
}

TEST_F(RecordedIncident, IsBoundedAndSaysWhatIsLeftOut) {
  CurveLimits limits;
  limits.most_curves = 2;
  const RecordedCurves shown = value_of(curves(RoverRecording().bytes(), limits));
  EXPECT_THAT(shown.curves, SizeIs(2));
  EXPECT_THAT(shown.remarks, Contains("2 more curves are left out here; the recording has all."));
  limits.most_messages = 1000;
  const RecordedCurves beginning = value_of(curves(RoverRecording().bytes(), limits));
  EXPECT_LT(beginning.end, kStart + 2 * kSecondInNanoseconds);
  EXPECT_THAT(beginning.remarks, Contains(HasSubstr("only its beginning")));
  limits.most_file = 100;
  const auto refused = curves(RoverRecording().bytes(), limits);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), HasSubstr("too large"));
}

TEST_F(RecordedIncident, OfAFileThatWasCutOffIsWhatIsWholeOfIt) {
  const std::string whole = bag::test::mcap_begin() + RoverRecording().data();
  const RecordedCurves all = value_of(curves(whole));
  EXPECT_THAT(all.remarks, Contains(HasSubstr("not whole")));
  std::size_t shown_before = 0;
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    const auto some = curves(whole.substr(0, size));
    if (!some) {
      EXPECT_THAT(some.error(), HasSubstr("_TooFast.mcap")) << size;
      continue;
    }
    std::size_t points = 0;
    for (const Curve& each : some->curves) points += each.points.size();
    EXPECT_GE(points + 2, shown_before) << size;
    shown_before = points;
  }
  EXPECT_GT(shown_before, 250u);
}

TEST_F(RecordedIncident, OfAForeignFileIsNothingAndThatIsSaid) {
  for (const std::string& foreign :
       {std::string(), std::string("this is no recording"), std::string(10'000, '\0')}) {
    const auto shown = curves(foreign);
    ASSERT_FALSE(shown);
    EXPECT_THAT(shown.error(),
                testing::AllOf(HasSubstr("_TooFast.mcap"),
                               testing::AnyOf(HasSubstr("not MCAP"), HasSubstr("is empty"))));
  }
  const auto missing = recorded_curves(folder / "none.mcap", {rules_of_rover(), {}, {}});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error(), HasSubstr("there is no such bag"));
}

TEST_F(RecordedIncident, OfDamagedBytesIsBounded) {
  const std::string whole = bag::test::mcap_begin() + RoverRecording().data();
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = whole;
    for (int n = 0; n < 20; ++n) bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto shown = curves(bytes);
    if (!shown) continue;
    EXPECT_THAT(shown->curves, SizeIs(Le(CurveLimits().most_curves)));
    for (const Curve& each : shown->curves)
      EXPECT_THAT(each.points, SizeIs(Le(2 * bag::ThinnedCurve::kMostBuckets)));
  }
}

TEST_F(RecordedIncident, TakesNoGraphForGranted) {
  for (const std::string& graph :
       {std::string(), std::string("null"), std::string("[]"), std::string(R"({"nodes":7})"),
        std::string(
            R"({"nodes":[7,{"name":7},{"name":"/drive"},{"name":"/drive","publishes":[]}]})"),
        std::string(200'000, '['), std::string("{\"nodes\":[{\"name\":\"\xff\"}]}")}) {
    RoverRecording recording;
    recording.graph = graph;
    EXPECT_THAT(names(value_of(curves(recording.bytes()))),
                ElementsAre("speed (/speed data)", "time between messages of /scan"))
        << graph.substr(0, 100);
  }
}

// Rules that are not known any more leave what has no need of them.
TEST_F(RecordedIncident, OfUnknownRulesIsNothing) {
  const RuleSet none;
  const RecordedCurves shown =
      value_of(recorded_curves(write(RoverRecording().bytes()), {none, {"TooFast"}, {"drive"}}));
  EXPECT_THAT(shown.curves, IsEmpty());
}

}  // namespace
}  // namespace culprit::incident_reports
