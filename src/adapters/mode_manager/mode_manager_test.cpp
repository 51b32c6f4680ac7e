// The mode manager against a managed node, both on DDS.
#include "mode_manager/mode_manager.h"

#include <gtest/gtest.h>

#include "modes/read_model.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"

namespace culprit::mode_manager {
namespace {

using rtps::EventLog;
using rtps::kPatience;

constexpr const char* kManagedPlant = R"(
plant: {ros__parameters: {type: system, parts: pump, modes: {
  __DEFAULT__: {pump: active},
  fast:        {pump: active.FAST},
  off:         {pump: inactive}},
  rules: {cool_down: {if_target: active.fast, if_part: [pump, inactive], new_target: active.off}}}}
pump: {ros__parameters: {type: node, modes: {
  __DEFAULT__: {ros__parameters: {rate: 1}},
  FAST:        {ros__parameters: {rate: 9}}}}}
)";

// A pump that is configured, with a rate of 5, which is no mode.
struct Pump {
  explicit Pump(const ros2::TestDomain& domain) : context(domain.options()) {
    context.run([&] {
      node = std::move(*ros2::LifecycleNode::create(*context, {"/", "pump"}, {}));
      (void)node->node().parameters().declare("rate", Value(std::int64_t{5}));
      node->trigger(ros2::TransitionId::kConfigure);
    });
  }
  ~Pump() {
    context.run([&] { node.reset(); });
  }
  LifecycleState state() {
    LifecycleState now{};
    context.run([&] { now = node->state(); });
    return now;
  }
  std::int64_t rate() {
    std::int64_t now = 0;
    context.run([&] { now = node->node().parameters().get<std::int64_t>("rate"); });
    return now;
  }
  void change(ros2::TransitionId transition) {
    context.run([&] { node->trigger(transition); });
  }
  ros2::LiveContext context;
  std::unique_ptr<ros2::LifecycleNode> node;
};

// The manager on an executor of its own, and its reports.
struct Manager {
  explicit Manager(const ros2::TestDomain& domain) {
    ModeManager::Options options;
    options.participant = domain.options();
    options.on_change = [this](const modes::Inference::Change& change) {
      told.add(change.entity->name + " " + std::string(ros2::label_of(change.now.state)) + " " +
               change.now.mode);
    };
    options.on_trouble = [this](const std::string& text) { told.add(text); };
    manager = std::move(*ModeManager::create(executor, model, std::move(options)));
    thread = std::thread([this] { executor.run(); });
  }
  ~Manager() {
    executor.stop();
    thread.join();
  }
  bool tells(const std::string& what) {
    return told.wait_for_one([&](const std::string& text) { return text == what; });
  }
  const modes::Model model = *modes::read_model("plant.yaml", kManagedPlant);
  EventLog<std::string> told;
  ros2::Executor executor;
  std::unique_ptr<ModeManager> manager;
  std::thread thread;
};

// Somebody who asks.
struct Asker {
  explicit Asker(const ros2::TestDomain& domain)
      : context(domain.options()), node(*context, {"/", "asker"}) {}

  template <class Service>
  typename Service::Response ask(const std::string& service,
                                 const typename Service::Request& request) {
    const auto client =
        std::move(*ros2::ServiceClient::create(node, {service, std::string(Service::kType)}));
    EventLog<typename Service::Response> answers;
    client->call(rtps::encode(request), ros2::Repeat::kUntilAnswered, kPatience,
                 [&](const ros2::CallResult& result) {
                   const auto response = rtps::decode<typename Service::Response>(result.reply);
                   answers.add(response ? *response : typename Service::Response{});
                 });
    EXPECT_TRUE(answers.wait_for_count(1)) << service;
    return answers.all().front();
  }
  bool change(const std::string& entity, const std::string& mode) {
    return ask<ros2::srv::ChangeMode>(entity + "/change_mode", {mode}).success;
  }
  std::string mode(const std::string& entity) {
    return ask<ros2::srv::GetMode>(entity + "/get_mode", {}).current_mode;
  }
  ros2::LiveContext context;
  ros2::NodeEntry node;
};

TEST(ModeManager, ChangesModesAndInfersThem) {
  const ros2::TestDomain domain;
  Pump pump(domain);
  Manager manager(domain);
  Asker asker(domain);
  ASSERT_TRUE(manager.tells("/plant inactive off"));
  EXPECT_EQ(asker.mode("/pump"), "unknown");

  EXPECT_TRUE(asker.change("/plant", "fast"));
  EXPECT_TRUE(manager.tells("/plant active fast"));
  EXPECT_EQ(asker.mode("/plant"), "fast");
  EXPECT_EQ(asker.mode("/pump"), "FAST");
  EXPECT_EQ(pump.rate(), 9);
  EXPECT_EQ(pump.state(), LifecycleState::kActive);
  EXPECT_EQ(asker.ask<ros2::srv::GetState>("/plant/get_state", {}).current_state.label, "active");

  EXPECT_FALSE(asker.change("/plant", "turbo"));
  EXPECT_TRUE(manager.tells("/plant was asked for mode 'turbo', which it does not have"));
  EXPECT_EQ(asker.mode("/plant"), "fast");

  const auto modes = asker.ask<srv::GetAvailableModes>("/plant/get_available_modes", {});
  EXPECT_EQ(modes.available_modes, (std::vector<std::string>{"__DEFAULT__", "fast", "off"}));

  pump.change(ros2::TransitionId::kDeactivate);
  EXPECT_TRUE(manager.tells("/plant: rule cool_down aims at active.off"));
  EXPECT_TRUE(manager.tells("/plant active off"));

  EXPECT_TRUE(asker.ask<ros2::srv::ChangeState>("/plant/change_state", {{3, ""}}).success);
  EXPECT_TRUE(manager.tells("/plant active __DEFAULT__"));
  EXPECT_EQ(pump.rate(), 1);
}

TEST(ModeManager, KnowsTheModesThatAPredecessorSet) {
  const ros2::TestDomain domain;
  Pump pump(domain);
  Asker asker(domain);
  {
    Manager first(domain);
    ASSERT_TRUE(first.tells("/plant inactive off"));
    EXPECT_TRUE(asker.change("/plant", "fast"));
    ASSERT_TRUE(first.tells("/plant active fast"));
  }
  Manager second(domain);
  EXPECT_TRUE(second.tells("/plant active fast"));
}

}  // namespace
}  // namespace culprit::mode_manager
