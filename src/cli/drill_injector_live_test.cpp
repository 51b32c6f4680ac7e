// A fault whose node obeys late, or otherwise than asked, is taken back all the same.
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/drill_injector.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/options.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using drill::Fault;
using drill::FaultKind;
using testing::HasSubstr;

constexpr Duration kLate = 4s;  // a drill waits for 3 s

// An active node with the parameter "exposure".
struct Camera {
  explicit Camera(ros2::LifecycleCallbacks callbacks = {}) {
    context.run([&] {
      node =
          std::move(*ros2::LifecycleNode::create(*context, {"/", "camera"}, std::move(callbacks)));
      EXPECT_TRUE(node->node().parameters().declare("exposure", Value(0.5)));
      EXPECT_TRUE(node->trigger(ros2::TransitionId::kConfigure));
      EXPECT_TRUE(node->trigger(ros2::TransitionId::kActivate));
    });
  }
  ~Camera() {
    context.run([&] { node.reset(); });
  }
  LifecycleState state() {
    LifecycleState now{};
    context.run([&] { now = node->state(); });
    return now;
  }
  double exposure() {
    double now = 0;
    context.run([&] { now = node->node().parameters().get<double>("exposure"); });
    return now;
  }

  ros2::LiveContext context{*ros2::options_from_environment()};
  std::unique_ptr<ros2::LifecycleNode> node;
};

struct Injector : testing::Test {
  drill::Injected prepared(Fault fault) {
    const auto out = injector.prepare(fault, "/camera", 0);
    EXPECT_TRUE(out) << out.error();
    return out ? *out : drill::Injected{};
  }

  TestWorld world;
  std::unique_ptr<DrillNode> node = std::move(*DrillNode::join());
  DrillInjector injector{*node};
};
using DrillInjectorAtANode = Injector;

TEST_F(DrillInjectorAtANode, ThatDeactivatesLateActivatesItAgain) {
  ros2::LifecycleCallbacks callbacks;
  callbacks.on_deactivate = [] {
    std::this_thread::sleep_for(kLate);
    return ros2::TransitionResult::kSuccess;
  };
  Camera camera(callbacks);
  const drill::Injected fault = prepared({FaultKind::kDeactivate, "camera"});
  EXPECT_FALSE(injector.inject(fault, 1s)) << "no answer yet";
  EXPECT_TRUE(injector.undo(fault));
  EXPECT_EQ(camera.state(), LifecycleState::kActive);
}

TEST_F(DrillInjectorAtANode, ThatTakesAParameterLateSetsItBack) {
  Camera camera;
  const drill::Injected fault =
      prepared({FaultKind::kSetParameter, "camera", "exposure", Value(9.0)});
  std::promise<void> begun;
  std::thread busy([&] {
    camera.context.run([&] {
      begun.set_value();
      std::this_thread::sleep_for(kLate);
    });
  });
  begun.get_future().wait();
  EXPECT_FALSE(injector.inject(fault, 1s)) << "no answer yet";
  EXPECT_TRUE(injector.undo(fault));
  busy.join();
  EXPECT_EQ(camera.exposure(), 0.5);
}

TEST_F(DrillInjectorAtANode, ThatRefusesAParameterLeavesNothingToUndo) {
  Camera camera;
  const drill::Injected fault =
      prepared({FaultKind::kSetParameter, "camera", "exposure", Value(9.0)});
  camera.context.run([&] {
    camera.node->node().parameters().on_set(
        [](auto) -> Expected<void> { return Error{"out of range"}; });
  });
  const auto injected = injector.inject(fault, 1s);
  ASSERT_FALSE(injected);
  EXPECT_THAT(injected.error(), HasSubstr("out of range"));
  const auto undone = injector.undo(fault);
  ASSERT_TRUE(undone) << undone.error();
  EXPECT_FALSE(*undone);
}

}  // namespace
}  // namespace culprit::cli
