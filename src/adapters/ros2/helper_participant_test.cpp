#include "ros2/helper_participant.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "ros2/hearing.h"
#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/sample_gaps.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// A robot's domain, and a helper that reaches it.
class HelpedDomain {
 public:
  ParticipantOptions helped(std::vector<std::string> manners = {}) {
    HelperOptions helper;
    // It leaves its process id to the test.
    helper.command = {"/bin/sh",
                      "-c",
                      "echo $$ >> \"$0\"; exec \"$@\"",
                      pids().string(),
                      CULPRIT_PEER_HELPER,
                      std::to_string(domain.number())};
    helper.command.insert(helper.command.end(), manners.begin(), manners.end());
    for (char** each = environ; *each != nullptr; ++each) helper.environment.emplace_back(*each);
    helper.name = "culprit";
    helper.on_trouble = [this](const std::string& text) { troubles.add(text); };
    ParticipantOptions options = domain.options();
    options.helper = std::make_shared<const HelperOptions>(std::move(helper));
    return options;
  }
  std::vector<int> started() const {
    std::ifstream file(pids());
    return {std::istream_iterator<int>(file), {}};
  }
  std::filesystem::path pids() const { return folder / "pids"; }

  const TestDomain domain{};
  const test::TestFolder folder;
  rtps::EventLog<std::string> troubles;
};

// A node on DDS with a service of its own.
struct HelpedRobot {
  explicit HelpedRobot(const TestDomain& domain) : context(domain.options()) {
    context.run([&] { node = std::move(*Node::create(*context, {"/", "robot"})); });
  }
  ~HelpedRobot() {
    context.run([&] { node.reset(); });
  }
  LiveContext context;
  std::unique_ptr<Node> node;
};

struct HelpedManager {
  explicit HelpedManager(const ParticipantOptions& options)
      : context(options), node(*context, {"/", "culprit"}) {}
  LiveContext context;
  NodeEntry node;
};

TEST(HelperParticipant, ShowsTheGraphAsDiscoveryDoes) {
  HelpedDomain robots;
  HelpedRobot robot(robots.domain);
  HelpedManager manager(robots.helped());
  EXPECT_TRUE(
      manager.context.sees_endpoint("/robot", EndpointKind::kServer, "/robot/get_parameters"));
  EXPECT_TRUE(manager.context.sees_endpoint("/robot", EndpointKind::kPublisher, "/rosout"));
  robot.context.run([&] { robot.node.reset(); });
  EXPECT_TRUE(manager.context.sees_node_leave("/robot"));
}

TEST(HelperParticipant, ReceivesSamplesAndPublishes) {
  HelpedDomain robots;
  HelpedManager manager(robots.helped());
  rtps::EventLog<double> there, here;
  LiveContext robot(robots.domain.options());
  const auto node = std::move(*Node::create(*robot, {"/", "robot"}));
  auto light = std::move(*node->create_publisher<msg::Float64>("/light"));
  const auto hears = std::move(*node->create_subscription<msg::Float64>(
      "/wish", rtps::qos::kDefault, [&](const msg::Float64& wish) { there.add(wish.data); }));
  const auto subscription = std::move(*RawSubscription::create(
      manager.node, "/light", msg::Float64::kType, rtps::qos::kSensorData, PayloadUse::kWhole,
      [&](const Sample& sample) {
        EXPECT_NE(sample.identity.writer, rtps::Guid{});
        if (const auto message = rtps::decode<msg::Float64>(sample.payload))
          here.add(message->data);
      }));
  const auto wish = std::move(
      *RawPublisher::create(manager.node, "/wish", msg::Float64::kType, rtps::qos::kDefault));
  const Time end = later(live_now(), rtps::kPatience);
  while (live_now() < end && (there.all().empty() || here.all().empty())) {
    light.publish({1.5});
    wish->publish(rtps::encode(msg::Float64{2.5}));
    std::this_thread::sleep_for(20ms);
  }
  ASSERT_FALSE(here.all().empty());
  ASSERT_FALSE(there.all().empty());
  EXPECT_EQ(here.all()[0], 1.5);
  EXPECT_EQ(there.all()[0], 2.5);
}

TEST(HelperParticipant, CallsServicesAndServes) {
  HelpedDomain robots;
  HelpedRobot robot(robots.domain);
  HelpedManager manager(robots.helped());
  const auto client = std::move(*ServiceClient::create(
      manager.node, {"/robot/get_parameters", std::string(srv::GetParameters::kType)},
      rtps::qos::kParameterServices));
  rtps::EventLog<CallOutcome> outcomes;
  client->call(rtps::encode(srv::GetParameters::Request{}), Repeat::kUntilAnswered, rtps::kPatience,
               [&](const CallResult& result) { outcomes.add(result.outcome); });
  ASSERT_TRUE(outcomes.wait_for_count(1));
  EXPECT_EQ(outcomes.all()[0], CallOutcome::kAnswered);

  const ServiceName pause{"/culprit/pause", std::string(srv::Trigger::kType)};
  const auto server = std::move(
      *ServiceServer::create(manager.node, pause, rtps::qos::kServices, [](rtps::ByteView) {
        return rtps::encode(srv::Trigger::Response{true, "paused"});
      }));
  NodeEntry person(*robot.context, {"/", "person"});
  const auto asks = std::move(*ServiceClient::create(person, pause));
  rtps::EventLog<std::string> answers;
  asks->call(rtps::encode(srv::Trigger::Request{}), Repeat::kUntilAnswered, rtps::kPatience,
             [&](const CallResult& result) {
               const auto response = rtps::decode<srv::Trigger::Response>(result.reply);
               answers.add(response ? response->message : "none");
             });
  ASSERT_TRUE(answers.wait_for_count(1));
  EXPECT_EQ(answers.all()[0], "paused");
}

TEST(HelperParticipant, KnowsThatItsHelperDroppedASampleBeforeTheNextOneComes) {
  HelpedDomain robots;
  HelpedManager manager(robots.helped({"--drops"}));
  LiveContext robot(robots.domain.options());
  const auto node = std::move(*Node::create(*robot, {"/", "robot"}));
  auto light = std::move(*node->create_publisher<msg::Float64>("/light"));
  SampleGaps gaps;
  rtps::EventLog<SampleGaps::Step> steps;
  const auto subscription = std::move(*RawSubscription::create(
      manager.node, "/light", msg::Float64::kType, rtps::qos::kSensorData, PayloadUse::kWhole,
      [&](const Sample& sample) {
        steps.add(gaps.next(sample.identity.writer, sample.identity.sequence,
                            manager.context->participant().dropped_here()));
      }));
  const Time end = later(live_now(), rtps::kPatience);
  while (live_now() < end && steps.all().size() < 5) {
    light.publish({1.5});
    std::this_thread::sleep_for(20ms);
  }
  ASSERT_GE(steps.all().size(), 5U);
  for (const SampleGaps::Step& step : steps.all())
    EXPECT_EQ(step.lost_here, step.published > 1) << "each gap has one";
  EXPECT_GT(steps.all().back().published, 1U);
}

TEST(HelperParticipant, SaysWhyThereIsNone) {
  HelpedDomain robots;
  Executor executor;
  const auto why = [&](const ParticipantOptions& options) {
    const auto context = Context::create(executor, options);
    return context ? "" : context.error();
  };
  ParticipantOptions options = robots.domain.options();
  options.helper = std::make_shared<const HelperOptions>(HelperOptions{{"/no/such/program"}, {}});
  EXPECT_THAT(why(options), HasSubstr("/no/such/program cannot be run: No such file"));
  EXPECT_THAT(why(robots.helped({"--version", "9"})), HasSubstr("speaks version 9"));
  options.helper = std::make_shared<const HelperOptions>(HelperOptions{{"/bin/false"}, {}});
  EXPECT_THAT(why(options), HasSubstr("status 1"));
}

TEST(HelperParticipant, EndsAHelperThatSendsWhatIsNoFrameAndStartsAnother) {
  HelpedDomain robots;
  HelpedManager manager(robots.helped({"--oversized"}));
  EXPECT_TRUE(robots.troubles.wait_for_one([](const std::string& text) {
    return text.find("no frame of the protocol") != std::string::npos;
  }));
  EXPECT_TRUE(robots.troubles.wait_for_count(2));
  EXPECT_GE(robots.started().size(), 2U);
}

TEST(HelperParticipant, IsDeafWithoutAHelperForgetsNothingAndReplacesOneThatHangs) {
  HelpedDomain robots;
  HelpedRobot robot(robots.domain);
  Executor executor;
  rtps::EventLog<GraphChange> changes;
  Graph::Options graph;
  graph.listener = [&](const GraphChange& change) { changes.add(change); };
  auto context = std::move(*Context::create(executor, robots.helped(), std::move(graph)));
  auto hearing = std::move(*Hearing::begin(context->participant(), executor));
  std::thread thread([&] { executor.run(); });
  const auto is_there = [](const GraphChange& change) {
    const auto* joined = std::get_if<NodeJoined>(&change);
    return joined != nullptr && joined->node.name == "/robot";
  };
  const auto hears_since = [&](Time since) {
    const Time end = later(live_now(), rtps::kPatience);
    while (hearing->heard() < since && live_now() < end) std::this_thread::sleep_for(10ms);
    return live_now() < end;
  };
  const auto is_replaced = [&](std::size_t started) {
    const Time end = later(live_now(), rtps::kPatience);
    while (robots.started().size() < started && live_now() < end) std::this_thread::sleep_for(5ms);
    return live_now() < end;
  };
  EXPECT_TRUE(changes.wait_for_one(is_there));
  EXPECT_TRUE(hears_since(live_now()));
  kill(robots.started().back(), SIGSTOP);
  const Time stopped = live_now();
  while (hearing->doubtful() > live_now() && live_now() < later(stopped, rtps::kPatience))
    std::this_thread::sleep_for(10ms);
  EXPECT_LE(hearing->doubtful(), live_now());
  EXPECT_TRUE(robots.troubles.wait_for_one(
      [](const std::string& text) { return text.find("it hung") != std::string::npos; }));
  EXPECT_TRUE(is_replaced(2));
  EXPECT_TRUE(hears_since(live_now()));
  for (std::size_t kills = 1; kills <= 3; ++kills) {
    kill(robots.started().back(), SIGKILL);
    EXPECT_TRUE(is_replaced(2 + kills));
    EXPECT_TRUE(hears_since(live_now()));
  }
  EXPECT_FALSE(std::ranges::any_of(changes.all(), [](const GraphChange& change) {
    return std::holds_alternative<NodeLeft>(change) || std::holds_alternative<EndpointLeft>(change);
  }));
  executor.stop();
  thread.join();
  hearing.reset();
  context.reset();
}

TEST(HelperParticipant, HandsARequestToOneHelperOnly) {
  HelpedDomain robots;
  LiveContext robot(robots.domain.options());
  NodeEntry node(*robot, {"/", "robot"});
  const ServiceName never{"/robot/never", std::string(srv::Trigger::kType)};
  std::atomic<int> asked = 0;
  const auto server =
      std::move(*ServiceServer::create(node, never, rtps::qos::kServices, [&](rtps::ByteView) {
        ++asked;
        return rtps::Bytes();
      }));
  const std::string counts = (robots.folder / "counts").string();
  HelpedManager manager(robots.helped({"--counts", counts}));
  const auto client = std::move(*ServiceClient::create(manager.node, never));
  rtps::EventLog<CallOutcome> outcomes;
  client->call(rtps::encode(srv::Trigger::Request{}), Repeat::kNever, 8s,
               [&](const CallResult& result) { outcomes.add(result.outcome); });
  const Time end = later(live_now(), rtps::kPatience);
  while (asked == 0 && live_now() < end) std::this_thread::sleep_for(5ms);
  kill(robots.started().back(), SIGKILL);
  ASSERT_TRUE(outcomes.wait_for_count(1));
  EXPECT_EQ(outcomes.all()[0], CallOutcome::kTimedOut);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(robots.started().size(), 2U);
  std::ifstream file(counts);
  EXPECT_EQ((std::vector<int>{std::istream_iterator<int>(file), {}}.size()), 1U);
}

}  // namespace
}  // namespace culprit::ros2
