#include "ros2/node.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

using ::testing::ElementsAre;

// A node on a context of its own.
struct LiveNode {
  LiveNode(const TestDomain& domain, const NodeName& name) : context(domain.options()) {
    context.run([&] {
      auto created = Node::create(*context, name);
      if (!created) throw std::runtime_error(created.error());
      node = std::move(*created);
    });
  }
  LiveContext context;
  std::unique_ptr<Node> node;
};

// Calls a service of /robot and waits for the answer.
template <class Service>
typename Service::Response ask(LiveNode& from, const std::string& name,
                               const typename Service::Request& request) {
  const auto client = from.node->create_client<Service>(name);
  rtps::EventLog<typename Service::Response> answers;
  (*client)->call(request, Repeat::kUntilAnswered, rtps::kPatience, [&](const auto& answer) {
    if (answer.response) answers.add(*answer.response);
  });
  if (!answers.wait_for_count(1)) {
    ADD_FAILURE() << "no answer from " << name;
    return {};
  }
  return answers.all().front();
}

TEST(Node, AppearsWithEverythingThatToolsExpect) {
  const TestDomain domain;
  LiveNode robot(domain, {"/ns", "robot"});
  LiveContext watcher(domain.options());
  EXPECT_TRUE(watcher.sees_node("/ns/robot"));
  EXPECT_TRUE(watcher.sees_endpoint("/ns/robot", EndpointKind::kPublisher, "/rosout"));
  EXPECT_TRUE(watcher.sees_endpoint("/ns/robot", EndpointKind::kPublisher, "/parameter_events"));
  for (const char* service :
       {"get_parameters", "get_parameter_types", "set_parameters", "set_parameters_atomically",
        "describe_parameters", "list_parameters"}) {
    EXPECT_TRUE(watcher.sees_endpoint("/ns/robot", EndpointKind::kServer,
                                      "/ns/robot/" + std::string(service)));
  }
}

TEST(Node, AMinimalNodeHasNothingThatOthersWouldHaveToDiscover) {
  const TestDomain domain;
  LiveContext watcher(domain.options());
  LiveContext looking(domain.options());
  std::unique_ptr<Node> node;
  looking.run([&] {
    node = std::move(*Node::create(*looking, {"/", "_minimal"}, Node::Extent::kMinimal));
    node->log(Severity::kInfo, "nobody hears it");
  });
  EXPECT_TRUE(watcher.sees_node("/_minimal"));
  watcher.run([&] {
    for (const auto& each : watcher->graph().participants()) {
      for (const auto& owned : each.endpoints) EXPECT_NE(owned.node, "/_minimal");
    }
  });
  looking.run([&] { node.reset(); });
}

TEST(Node, RefusesABadName) {
  const TestDomain domain;
  LiveContext context(domain.options());
  EXPECT_FALSE(Node::create(*context, {"/", "a b"}));
  EXPECT_FALSE(Node::create(*context, {"ns", "a"}));
}

TEST(Node, ServesItsParameters) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  robot.context.run([&] { ASSERT_TRUE(robot.node->parameters().declare("gain", Value(1.0))); });

  EXPECT_THAT(ask<srv::ListParameters>(manager, "/robot/list_parameters", {}).names,
              ElementsAre("gain", "use_sim_time"));
  EXPECT_THAT(ask<srv::GetParameterTypes>(manager, "/robot/get_parameter_types", {{"gain"}}).types,
              ElementsAre(3));
  const auto set = ask<srv::SetParameters>(manager, "/robot/set_parameters",
                                           {{{"gain", to_parameter_value(2.5)},
                                             {"gain", to_parameter_value(false)},
                                             {"x", to_parameter_value(1.0)}}});
  ASSERT_EQ(set.results.size(), 3u);
  EXPECT_TRUE(set.results[0].successful);
  EXPECT_FALSE(set.results[1].successful);
  EXPECT_FALSE(set.results[2].successful);
  EXPECT_THAT(ask<srv::GetParameters>(manager, "/robot/get_parameters", {{"gain"}}).values,
              ElementsAre(to_parameter_value(2.5)));
  EXPECT_TRUE(ask<srv::SetParametersAtomically>(manager, "/robot/set_parameters_atomically",
                                                {{{"gain", to_parameter_value(3.0)}}})
                  .result.successful);
  EXPECT_EQ(ask<srv::DescribeParameters>(manager, "/robot/describe_parameters", {{"gain"}})
                .descriptors.front()
                .name,
            "gain");
}

TEST(Node, AnnouncesChangesOfItsParameters) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  rtps::EventLog<msg::ParameterEvent> events;
  const auto subscription = manager.node->create_subscription<msg::ParameterEvent>(
      "/parameter_events", rtps::qos::kParameterEvents,
      [&](const msg::ParameterEvent& event) { events.add(event); });
  ASSERT_TRUE(subscription);
  robot.context.run([&] { ASSERT_TRUE(robot.node->parameters().declare("gain", Value(1.0))); });
  // Volatile: only what is set after both sides have matched arrives. So until it does:
  double gain = 2;
  do {
    ask<srv::SetParameters>(manager, "/robot/set_parameters",
                            {{{"gain", to_parameter_value(++gain)}}});
  } while (events.all().empty());
  ASSERT_TRUE(events.wait_for_one(
      [](const msg::ParameterEvent& event) { return !event.changed_parameters.empty(); }));
  const msg::ParameterEvent event = events.all().back();
  EXPECT_EQ(event.node, "/robot");
  EXPECT_EQ(event.changed_parameters.front().name, "gain");
  EXPECT_GT(event.stamp.sec, 0);
}

TEST(Node, LogsToRosout) {
  const TestDomain domain;
  LiveNode robot(domain, {"/ns", "robot"});
  robot.node->log(Severity::kWarn, "mind the gap");
  LiveNode manager(domain, {"/", "manager"});
  rtps::EventLog<msg::Log> logs;
  const auto subscription = manager.node->create_subscription<msg::Log>(
      "/rosout", rtps::qos::kRosout, [&](const msg::Log& log) { logs.add(log); });
  ASSERT_TRUE(subscription);
  ASSERT_TRUE(logs.wait_for_count(1));
  const msg::Log log = logs.all().front();
  EXPECT_EQ(log.name, "ns.robot");
  EXPECT_EQ(log.msg, "mind the gap");
  EXPECT_EQ(log.level, 30);
}

TEST(Node, PublishesToItsSubscribers) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  auto publisher = robot.node->create_publisher<msg::Float64>(
      "~/value", {.durability = rtps::Durability::kTransientLocal});
  ASSERT_TRUE(publisher);
  rtps::EventLog<double> values;
  const auto subscription = manager.node->create_subscription<msg::Float64>(
      "/robot/value", {.durability = rtps::Durability::kTransientLocal},
      [&](const msg::Float64& message) { values.add(message.data); });
  ASSERT_TRUE(subscription);
  EXPECT_TRUE(publisher->publish({1.5}));
  ASSERT_TRUE(values.wait_for_count(1));
  EXPECT_EQ(values.all().front(), 1.5);
}

TEST(Node, ABusyExecutorDropsTheOldestSamples) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  auto publisher = robot.node->create_publisher<msg::Float64>("/t");
  ASSERT_TRUE(publisher);
  rtps::EventLog<double> values, raw;
  const auto subscription = manager.node->create_subscription<msg::Float64>(
      "/t", {.depth = 2}, [&](const msg::Float64& message) { values.add(message.data); });
  const auto watcher = RawSubscription::create(
      manager.node->entry(), "/t", msg::Float64::kType, {}, PayloadUse::kWhole,
      [&](const Sample& sample) { raw.add(rtps::decode<msg::Float64>(sample.payload)->data); });
  ASSERT_TRUE(subscription);
  ASSERT_TRUE(watcher);
  // Both are matched when both have received something.
  do {
    publisher->publish({-1});
    std::this_thread::yield();
  } while (values.all().empty() || raw.all().empty());
  manager.context.run([] {});

  manager.context.run([&] {
    for (const double value : {1, 2, 3, 4, 5, 6}) publisher->publish({value});
    // The receive thread goes on meanwhile. Which reader it serves first is its own affair: where
    // one has received the sixth, the other has received the fifth.
    raw.wait_for_one([](double value) { return value == 6; });
  });
  ASSERT_TRUE(values.wait_for_one([](double value) { return value == 6; }));
  const auto all = values.all();
  EXPECT_THAT(std::vector<double>(all.end() - 2, all.end()), ElementsAre(5, 6));
  EXPECT_THAT(all, ::testing::Not(::testing::Contains(3)));
}

TEST(Node, SkipsMessagesThatAreNotWellFormed) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  const rtps::Qos qos{.durability = rtps::Durability::kTransientLocal};
  const auto raw = RawPublisher::create(robot.node->entry(), "/t", msg::String::kType, qos);
  ASSERT_TRUE(raw);
  (*raw)->publish(rtps::Bytes{0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff});
  (*raw)->publish(rtps::encode(msg::String{"good"}));
  rtps::EventLog<std::string> texts;
  const auto subscription = manager.node->create_subscription<msg::String>(
      "/t", qos, [&](const msg::String& message) { texts.add(message.data); });
  ASSERT_TRUE(texts.wait_for_count(1));
  EXPECT_EQ(texts.all().front(), "good");
}

TEST(Node, OffersServices) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"}), manager(domain, {"/", "manager"});
  const auto server = robot.node->create_service<srv::SetBool>(
      "~/switch", [](const srv::SetBool::Request& request) {
        return srv::SetBool::Response{request.data, request.data ? "on" : "off"};
      });
  ASSERT_TRUE(server);
  EXPECT_EQ(ask<srv::SetBool>(manager, "/robot/switch", {true}).message, "on");
}

TEST(Node, ServesItsOwnContextToo) {
  const TestDomain domain;
  LiveNode robot(domain, {"/", "robot"});
  EXPECT_THAT(ask<srv::ListParameters>(robot, "/robot/list_parameters", {}).names,
              ElementsAre("use_sim_time"));
}

}  // namespace
}  // namespace culprit::ros2
