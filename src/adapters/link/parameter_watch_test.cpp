#include "link/parameter_watch.h"

#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "ros2/live_test.h"
#include "ros2/parameter_store.h"
#include "ros2/publisher.h"
#include "ros2/timer.h"

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

// A component without a NODE: it is bound to the first node of its name that is seen.
constexpr const char* kParameterRule = R"(
COMPONENT robot
RULE R
  POLICIES ERROR REPORT
  TRIGGER parameter(robot, gain) > 2
)";

// A participant with one node, which publishes events of any node.
struct Speaker {
  Speaker(const ros2::TestDomain& domain, const ros2::NodeName& name)
      : context(domain.options()),
        node(*context, name),
        events(std::move(*ros2::RawPublisher::create(
            node, "/parameter_events", ros2::msg::ParameterEvent::kType, rtps::qos::kDefault))) {}
  void says(const std::string& of, const Value& value) {
    ros2::msg::ParameterEvent event;
    event.node = of;
    event.changed_parameters = {{"gain", ros2::to_parameter_value(value)}};
    events->publish(rtps::encode(event));
  }
  ros2::LiveContext context;
  ros2::NodeEntry node;
  std::unique_ptr<ros2::RawPublisher> events;
};

struct Watched {
  explicit Watched(const ros2::TestDomain& domain) : context(domain.options()) {
    EXPECT_TRUE(watch.start(node));
  }
  // As if its computer were busy, until the future is ready.
  void hold(std::future<void> until) {
    std::promise<void> holds;
    tasks.post([&holds, wait = std::make_shared<std::future<void>>(std::move(until))] {
      holds.set_value();
      wait->wait();
    });
    holds.get_future().wait();
  }

  const RuleSet rules = *check(Source("test.rules", kParameterRule)).rules;
  Inbox inbox;
  ComponentBinding binding{rules};
  ros2::LiveContext context;
  ros2::NodeEntry node{*context, {"/", "culprit"}};
  OtherNodes others{node, binding, inbox};
  rtps::EventLog<ComponentId> asked;
  ParameterWatch watch{
      *context, context->executor(), rules, inbox, binding, others, [this](ComponentId component) {
        asked.add(component);
      }};
  ros2::TaskGroup tasks{context->executor()};
};

// culprit has bound the component to the robot's node, of which a stranger publishes events.
struct WatchedAmongStrangers {
  WatchedAmongStrangers() {
    EXPECT_TRUE(watched.context.sees_node("/robot"));
    watched.context.run([this] { EXPECT_TRUE(watched.binding.bind("/robot")); });
  }
  // For so long after the stranger was first received.
  void hear_lies(std::chrono::milliseconds more) {
    ros2::Timer lies(stranger.context->executor(), 20ms,
                     [this] { stranger.says("/robot", Value(9.0)); });
    EXPECT_TRUE(watched.asked.wait_for_count(1)) << "the stranger is received";
    std::this_thread::sleep_for(more);
  }

  const ros2::TestDomain domain;
  Watched watched{domain};
  Speaker robot{domain, {"/", "robot"}};
  Speaker stranger{domain, {"/", "stranger"}};
};

TEST(ParameterWatch, AsksANodeWhoseEventHasNoRoomBesideAFlood) {
  WatchedAmongStrangers all;
  Watched& watched = all.watched;
  all.hear_lies(0ms);
  std::this_thread::sleep_for(1500ms);  // so that it may be asked again
  const std::size_t before = watched.asked.all().size();

  std::promise<void> goes_on;
  watched.hold(goes_on.get_future());
  // Until nothing of the last size fits, of which the robot's is, too.
  const std::size_t large = 2 * ros2::msg::ParameterEvent::kLargest / 50'000;
  for (const auto& [size, count] : std::map<std::size_t, std::size_t, std::greater<>>{
           {50'000, large}, {1'000, 150}, {10, 100}}) {
    for (std::size_t i = 0; i < count; ++i) {
      all.stranger.says("/other", Value(std::string(size, 'x')));
      std::this_thread::sleep_for(2ms);
    }
  }
  for (int i = 0; i < 3; ++i) all.robot.says("/robot", Value(std::string(10, 'x')));
  std::this_thread::sleep_for(100ms);
  goes_on.set_value();
  EXPECT_TRUE(watched.asked.wait_for_count(before + 1));
}

TEST(ParameterWatch, AsksOnceMoreAfterTheLastEventOfOthers) {
  WatchedAmongStrangers all;
  all.hear_lies(200ms);
  EXPECT_TRUE(all.watched.asked.wait_for_count(2));
}

TEST(ParameterWatch, BindsNoComponentToANodeThatSomebodyNames) {
  const ros2::TestDomain domain;
  Watched watched(domain);
  Speaker stranger(domain, {"/", "stranger"});
  Speaker robot(domain, {"/", "robot"});
  ASSERT_TRUE(watched.context.sees_node("/robot"));
  ros2::Timer lies(stranger.context->executor(), 20ms,
                   [&] { stranger.says("/evil/robot", Value(9.0)); });
  std::this_thread::sleep_for(500ms);
  watched.context.run([&] {
    EXPECT_TRUE(watched.binding.bind("/robot"));
    EXPECT_EQ(watched.binding.node_of(ComponentId(0)), "/robot");
  });
}

}  // namespace
}  // namespace culprit::link
