// Checks the messages that the tap receives from a live robot, on loopback.
#include "recorder/robot_tap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/bag_file.h"
#include "base/live_clock.h"
#include "base/test_folder.h"
#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/publisher.h"

namespace culprit::recorder {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

struct RobotTaps : testing::Test {
  std::unique_ptr<RobotTap> tap(std::vector<std::string> topics, std::size_t large_bytes) {
    auto opened = RobotTap::open({.participant = domain.options(),
                                  .topics = TopicChoice(std::move(topics)),
                                  .before = std::chrono::seconds(20),
                                  .large_bytes = large_bytes,
                                  .say = [this](const std::string& text) { said.add(text); }},
                                 recorder);
    if (!opened) throw std::runtime_error(opened.error());
    return std::move(*opened);
  }
  std::unique_ptr<ros2::RawPublisher> publisher(const char* topic, const char* type,
                                                const rtps::Qos& qos = {}) {
    return std::move(*ros2::RawPublisher::create(node, topic, type, qos));
  }

  // Messages of `topic` in a recording made now.
  std::size_t recorded(const std::string& topic) { return sizes_recorded(topic).size(); }
  // Their sizes, in the order in which they came.
  std::vector<std::size_t> sizes_recorded(const std::string& topic) {
    std::vector<std::size_t> sizes;
    const auto made = recorder.record_now("test", rtps::kPatience);
    if (!made) return sizes;
    const std::string written = "messages: " + made->string();
    written_down.wait_for_one(
        [&](const std::string& text) { return text.find(written) != std::string::npos; });
    auto file = bag::BagFile::open(*made);
    if (!file) return sizes;
    for (bag::BagMessage message; file->next(message);) {
      if (file->contents().topics()[message.topic].name == topic)
        sizes.push_back(message.bytes.size());
    }
    return sizes;
  }
  // Publishes again and again until `is_enough`; false if it never is.
  bool publish_until(ros2::RawPublisher& from, const rtps::Bytes& payload,
                     const std::function<bool()>& is_enough) {
    for (const Time end = live_now() + rtps::kPatience; live_now() < end;) {
      from.publish(payload);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (is_enough()) return true;
    }
    return false;
  }

  ros2::TestDomain domain;
  test::TestFolder own;
  rtps::EventLog<std::string> said;
  rtps::EventLog<std::string> written_down;
  IncidentRecorder recorder{{.folder = own.path(),
                             .robot = "robot",
                             .library = "test",
                             .after = Duration::zero(),
                             .say = [this](const std::string& text) { written_down.add(text); }}};
  ros2::LiveContext robot{domain.options()};
  ros2::NodeEntry node{*robot, {"/", "robot"}};
};

TEST_F(RobotTaps, HearWhatWasLatchedBeforeTheyCame) {
  constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal, .depth = 1};
  const auto map = publisher("/map", "std_msgs/msg/String", kLatched);
  map->publish(rtps::encode(ros2::msg::String{"walls"}));
  const auto hears = tap({}, 1'000'000);
  const Time end = live_now() + rtps::kPatience;
  std::size_t count = 0;
  while (count == 0 && live_now() < end) count = recorded("/map");
  EXPECT_EQ(count, 1) << "one of the two readers receives it";
}

TEST_F(RobotTaps, GiveUpWhatIsTooLargeAndSayItOnce) {
  const auto camera = publisher("/camera", "sensor_msgs/msg/Image");
  const auto odd = publisher("/odd", "my_msgs/msg/Odd");
  const auto hears = tap({}, 1'000'000);
  ros2::msg::Image image;
  image.data.resize(300'000);
  EXPECT_TRUE(publish_until(*camera, rtps::encode(image), [&] {
    return std::ranges::any_of(said.all(), [](const std::string& text) {
      return text.find("/camera is not recorded") != std::string::npos;
    });
  }));
  for (int i = 0; i < 5; ++i) camera->publish(rtps::encode(image));
  EXPECT_TRUE(publish_until(*odd, {0, 1, 0, 0, 1}, [&] { return recorded("/odd") > 0; }))
      << "a message of an unknown type is kept";
  EXPECT_THAT(said.all(), SizeIs(2));
  EXPECT_THAT(said.all(), testing::Contains(HasSubstr("my_msgs/msg/Odd is not known")));
}

// A topic that begins small and becomes large is received in another way from then on.
TEST_F(RobotTaps, HearWhatBecomesLargeOnTheWay) {
  const auto scan = publisher("/scan", "std_msgs/msg/String");
  const auto hears = tap({}, 1'000'000);
  const auto of_size = [](std::size_t size) {  // so that nothing has to be filled up
    return rtps::encode(ros2::msg::String{std::string(size, 'x')});
  };
  EXPECT_TRUE(publish_until(*scan, of_size(99), [&] { return recorded("/scan") > 3; }));
  const std::vector<std::size_t> sizes = {99, RobotTap::kSmall + 99, 39'999, 99, 39'999};
  for (const std::size_t size : sizes) {
    const std::size_t wanted = of_size(size).size();
    const auto is_there = [&] {
      const auto all = sizes_recorded("/scan");
      return !all.empty() && all.back() == wanted;
    };
    EXPECT_TRUE(publish_until(*scan, of_size(size), is_there)) << size;
  }
}

TEST_F(RobotTaps, KeepWhatIsNamedHoweverLargeItIs) {
  const auto camera = publisher("/camera", "sensor_msgs/msg/Image");
  const auto hears = tap({"/cam*"}, 1);
  ros2::msg::Image image;
  image.data.resize(300'000);
  EXPECT_TRUE(publish_until(*camera, rtps::encode(image), [&] { return recorded("/camera") > 3; }));
  EXPECT_THAT(said.all(), SizeIs(0));
}

}  // namespace
}  // namespace culprit::recorder
