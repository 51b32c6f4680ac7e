// Signals that rules read from a bag.
#include "bag/bag_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/test_bag.h"
#include "bag/test_mcap.h"
#include "language/checker.h"

namespace culprit::bag {
namespace {

using test::BagTest;
using test::number;
using test::text_of;
using test::value_of;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera
SIGNAL visibility TOPIC /water_visibility FIELD data
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy
RULE R
  POLICIES ERROR
  TRIGGER visibility < 1 || entropy > 1 || lifecycle(camera) != "active" || age(/lidar) > 1s
    STRATEGY restart 50 10
      ADAPTATION camera restart 2
)";

// Values and what else was seen, by time.
std::vector<std::pair<std::int64_t, std::string>> said_by(const std::vector<Observation>& seen) {
  std::vector<std::pair<std::int64_t, std::string>> said;
  for (const Observation& o : seen) {
    const std::int64_t at = o.at.time_since_epoch().count();
    if (const auto* signal = std::get_if<SignalRead>(&o.what))
      said.emplace_back(at, to_string(signal->value));
    if (const auto* node = std::get_if<NodeAppeared>(&o.what))
      said.emplace_back(at, "node " + node->node);
    if (const auto* state = std::get_if<LifecycleRead>(&o.what))
      said.emplace_back(at, state->state == Lifecycle::kActive ? "active" : "?");
  }
  return said;
}

struct Seen {
  std::vector<std::pair<std::int64_t, std::string>> said;
  std::vector<std::string> missing;
};

Seen read(const std::filesystem::path& path, const char* rules) {
  const auto checked = check(Source("t", rules));
  ros2::MessageLibrary library;
  BagFile bag = value_of(BagFile::open(path));
  BagReading reading(*checked.rules, bag.contents(), library);
  std::vector<Observation> seen;
  BagMessage message;
  while (bag.next(message)) reading.read(message, seen);
  return {said_by(seen), reading.missing()};
}

TEST_F(BagTest, ShowsTopicsFieldsDiagnosticsAndLifecyclesInTheOrderOfTime) {
  {
    auto second = make("bag_10.db3");
    add(second, 1, 400, text_of(number(0.5)));
    auto first = make("bag_9.db3");
    ros2::msg::TransitionEvent event;
    event.goal_state.label = "active";
    add(first, 2, 300, text_of(rtps::encode(event)));
    add(first, 1, 100, text_of(number(2.5)));
    ros2::msg::DiagnosticArray array;
    array.status.resize(1);
    array.status[0].name = "segmentation";
    array.status[0].values = {{"entropy", "0.25"}};
    add(first, 3, 200, text_of(rtps::encode(array)));
    add(first, 1, -5, text_of(number(9)));  // no recorder writes that
    add(first, 3, 250, "garbage");          // nor that
  }
  const Seen seen = read(folder_, kRules);
  EXPECT_THAT(seen.missing, testing::ElementsAre("topic /lidar is not in the bag"));
  const std::vector<std::pair<std::int64_t, std::string>> expected = {
      {100, "2.5"}, {200, "\"0.25\""}, {300, "node /camera"}, {300, "active"}, {400, "0.5"}};
  EXPECT_EQ(seen.said, expected);
}

TEST_F(BagTest, ReadsTypesThatOnlyTheBagDescribes) {
  const std::string definition = "Depth[] depths\n" + std::string(80, '=') +
                                 "\nMSG: my_msgs/Depth\nuint8 quality\nfloat64 metres\n" +
                                 std::string(80, '=') + "\nMSG: my_msgs/Unused\n";
  rtps::Bytes bytes = {0, 1, 0, 0, 1, 0, 0, 0, 7, 0, 0, 0};  // one depth, of quality 7
  const rtps::Bytes metres = number(1.5);
  bytes.insert(bytes.end(), metres.begin() + 4, metres.end());
  write("a.mcap",
        test::mcap(test::schema(4, "my_msgs/msg/Sonar", definition) +
                       test::channel(1, 4, "/sonar") + test::channel(2, 0, "/map", "json") +
                       test::message(1, 10, text_of(bytes)) + test::message(2, 20, "{}"),
                   2));
  const Seen seen = read(folder_ / "a.mcap", R"(
COMPONENT sonar NODE /sonar
SIGNAL depth TOPIC /sonar FIELD depths[0].metres
SIGNAL size TOPIC /map FIELD size
RULE R
  POLICIES ERROR
  TRIGGER depth < 1 || size > 1
    STRATEGY restart 50 10
      ADAPTATION sonar restart 2
)");
  EXPECT_THAT(seen.said, testing::ElementsAre(testing::Pair(10, "1.5")));
  EXPECT_THAT(seen.missing, testing::ElementsAre("the messages of /map are in 'json', not in CDR"));
}

TEST_F(BagTest, KnowsNodesByWhatTheyLog) {
  const auto log = [](std::uint64_t at, const std::string& name) {
    ros2::msg::Log message;
    message.name = name;
    return test::message(1, at, text_of(rtps::encode(message)));
  };
  write("a.mcap",
        test::mcap(test::schema(1, "rcl_interfaces/msg/Log", "") + test::channel(1, 1, "/rosout") +
                       log(1, "somebody") + log(2, "arm.gripper.planner") + log(3, "arm.gripper") +
                       log(4, "x.camera") + log(5, "camera"),
                   5));
  const Seen seen = read(folder_ / "a.mcap", R"(
COMPONENT gripper NODE /arm/gripper
COMPONENT camera
RULE R
  POLICIES ERROR
  TRIGGER !alive(gripper)
    STRATEGY restart 50 10
      ADAPTATION camera restart 2
)");
  EXPECT_THAT(seen.said, testing::ElementsAre(testing::Pair(2, "node /arm/gripper"),
                                              testing::Pair(5, "node /camera")));
}

}  // namespace
}  // namespace culprit::bag
