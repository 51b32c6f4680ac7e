#include "ros2/lifecycle_node.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

using ::testing::ElementsAre;

// A managed node on a context of its own, that records its requests.
struct Managed {
  explicit Managed(const TestDomain& domain, LifecycleCallbacks callbacks = {})
      : context(domain.options()) {
    context.run([&] {
      node = std::move(*LifecycleNode::create(*context, {"/", "robot"}, std::move(callbacks)));
    });
  }
  LifecycleState state() {
    LifecycleState now = LifecycleState::kUnknown;
    context.run([&] { now = node->state(); });
    return now;
  }
  LiveContext context;
  std::unique_ptr<LifecycleNode> node;
};

struct Manager {
  explicit Manager(const TestDomain& domain)
      : context(domain.options()),
        node(*context, {"/", "manager"}),
        client(std::move(*ServiceClient::create(
            node, {"/robot/change_state", std::string(srv::ChangeState::kType)},
            rtps::qos::kServices,
            {{"/robot/get_state", std::string(srv::GetState::kType)},
             rtps::encode(srv::GetState::Request{})}))) {}

  bool change(const msg::Transition& transition) {
    rtps::EventLog<bool> answers;
    client->call(
        rtps::encode(srv::ChangeState::Request{transition}), Repeat::kNever, rtps::kPatience,
        [&](const CallResult& result) {
          const auto response = rtps::decode<srv::ChangeState::Response>(result.reply);
          answers.add(result.outcome == CallOutcome::kAnswered && response && response->success);
        });
    return answers.wait_for_count(1) && answers.all().front();
  }

  LiveContext context;
  NodeEntry node;
  std::unique_ptr<ServiceClient> client;
};

TEST(LifecycleNode, IsSteeredFromOutside) {
  const TestDomain domain;
  Managed robot(domain);
  Manager manager(domain);
  EXPECT_FALSE(manager.change({3, ""}));
  EXPECT_TRUE(manager.change({1, ""}));
  EXPECT_EQ(robot.state(), LifecycleState::kInactive);
  EXPECT_TRUE(manager.change({0, "activate"}));
  EXPECT_EQ(robot.state(), LifecycleState::kActive);
  EXPECT_FALSE(manager.change({4, "no such label"}));
  EXPECT_TRUE(manager.change({4, "deactivate"}));
}

TEST(LifecycleNode, DoesItsWorkInTheTransitionState) {
  const TestDomain domain;
  std::vector<LifecycleState> seen;
  Managed* robot = nullptr;
  Managed managed(domain, {.on_configure =
                               [&] {
                                 seen.push_back(robot->node->state());
                                 return TransitionResult::kSuccess;
                               },
                           .on_cleanup = {},
                           .on_activate =
                               [&] {
                                 seen.push_back(robot->node->state());
                                 return TransitionResult::kFailure;
                               },
                           .on_deactivate = {},
                           .on_shutdown = {},
                           .on_error = {}});
  robot = &managed;
  managed.context.run([&] {
    EXPECT_TRUE(managed.node->trigger(TransitionId::kConfigure));
    EXPECT_FALSE(managed.node->trigger(TransitionId::kActivate));
    EXPECT_EQ(managed.node->state(), LifecycleState::kInactive);
  });
  EXPECT_THAT(seen, ElementsAre(LifecycleState::kConfiguring, LifecycleState::kActivating));
}

TEST(LifecycleNode, AnErrorIsProcessedAtOnce) {
  const TestDomain domain;
  const auto fails = [] { return TransitionResult::kError; };
  Managed recovers(domain, {.on_configure = fails,
                            .on_cleanup = {},
                            .on_activate = {},
                            .on_deactivate = {},
                            .on_shutdown = {},
                            .on_error = {}});
  Manager manager(domain);
  EXPECT_FALSE(manager.change({1, ""}));
  EXPECT_EQ(recovers.state(), LifecycleState::kUnconfigured);
}

TEST(LifecycleNode, AnErrorThatCannotBeProcessedIsTheEnd) {
  const TestDomain domain;
  Managed dies(domain, {.on_configure = [] { return TransitionResult::kError; },
                        .on_cleanup = {},
                        .on_activate = {},
                        .on_deactivate = {},
                        .on_shutdown = {},
                        .on_error = [] { return TransitionResult::kFailure; }});
  dies.context.run([&] {
    EXPECT_FALSE(dies.node->trigger(TransitionId::kConfigure));
    EXPECT_EQ(dies.node->state(), LifecycleState::kFinalized);
  });
}

TEST(LifecycleNode, TellsEachStep) {
  const TestDomain domain;
  Managed robot(domain);
  Manager manager(domain);
  rtps::EventLog<msg::TransitionEvent> events;
  const auto subscription = Subscription::create(
      manager.node, "/robot/transition_event", msg::TransitionEvent::kType, rtps::qos::kDefault,
      [&](rtps::ByteView payload) { events.add(*rtps::decode<msg::TransitionEvent>(payload)); });
  ASSERT_TRUE(subscription);
  // Volatile: until both sides have matched, events are missed.
  while (events.all().empty()) {
    EXPECT_TRUE(manager.change({1, ""}));
    EXPECT_TRUE(manager.change({2, ""}));
  }
  EXPECT_TRUE(manager.change({1, ""}));
  EXPECT_TRUE(manager.change({3, ""}));
  ASSERT_TRUE(events.wait_for_one(
      [](const msg::TransitionEvent& event) { return event.goal_state.label == "active"; }));
  const auto all = events.all();
  ASSERT_GE(all.size(), 4u);
  const auto last = all.end() - 4;
  EXPECT_EQ(last[0].goal_state, to_message(LifecycleState::kConfiguring));
  EXPECT_EQ(last[1].start_state, to_message(LifecycleState::kConfiguring));
  EXPECT_EQ(last[1].goal_state, to_message(LifecycleState::kInactive));
  EXPECT_EQ(last[2].goal_state, to_message(LifecycleState::kActivating));
  EXPECT_EQ(last[3].goal_state, to_message(LifecycleState::kActive));
  EXPECT_EQ(last[3].timestamp, 0u);  // as rcl leaves it
}

TEST(LifecycleNode, ListsItsStatesAndTransitions) {
  const TestDomain domain;
  Managed robot(domain);
  LiveContext other(domain.options());
  std::unique_ptr<Node> node;
  other.run([&] { node = std::move(*Node::create(*other, {"/", "manager"})); });
  rtps::EventLog<std::size_t> states, transitions, graph;
  const auto states_client =
      node->create_client<srv::GetAvailableStates>("/robot/get_available_states");
  (*states_client)->call({}, Repeat::kUntilAnswered, rtps::kPatience, [&](const auto& answer) {
    states.add(answer.response->available_states.size());
  });
  const auto now_client =
      node->create_client<srv::GetAvailableTransitions>("/robot/get_available_transitions");
  (*now_client)->call({}, Repeat::kUntilAnswered, rtps::kPatience, [&](const auto& answer) {
    transitions.add(answer.response->available_transitions.size());
  });
  const auto all_client =
      node->create_client<srv::GetAvailableTransitions>("/robot/get_transition_graph");
  (*all_client)->call({}, Repeat::kUntilAnswered, rtps::kPatience, [&](const auto& answer) {
    graph.add(answer.response->available_transitions.size());
  });
  ASSERT_TRUE(states.wait_for_count(1));
  ASSERT_TRUE(transitions.wait_for_count(1));
  ASSERT_TRUE(graph.wait_for_count(1));
  EXPECT_EQ(states.all().front(), 11u);
  EXPECT_EQ(transitions.all().front(), 2u);  // configure, shutdown
  EXPECT_EQ(graph.all().front(), 25u);
}

TEST(LifecycleNode, FiftyTransitionsByFreshManagersAreNeitherLostNorDoubled) {
  const TestDomain domain;
  std::vector<std::string> work;
  const auto note = [&work](std::string what) {
    return [&work, what] {
      work.push_back(what);
      return TransitionResult::kSuccess;
    };
  };
  Managed robot(domain, {.on_configure = note("configure"),
                         .on_cleanup = note("cleanup"),
                         .on_activate = {},
                         .on_deactivate = {},
                         .on_shutdown = {},
                         .on_error = {}});
  for (std::uint8_t i = 0; i < 50; ++i) {
    Manager manager(domain);
    ASSERT_TRUE(manager.change({static_cast<std::uint8_t>(1 + i % 2), ""})) << int{i};
  }
  robot.context.run([&] {
    ASSERT_EQ(work.size(), 50u);
    for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(work[i], i % 2 == 0 ? "configure" : "cleanup");
  });
}

}  // namespace
}  // namespace culprit::ros2
