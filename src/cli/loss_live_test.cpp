// A robot on another computer whose network loses one datagram in five, or two: nothing is broken.
#include <csignal>
#include <memory>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/lifecycle.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/publisher.h"
#include "ros2/timer.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// A managed node, active, that publishes /chatter twenty times a second.
class Talker {
 public:
  Talker() : context_(*ros2::options_from_environment()) {
    context_.run([&] {
      node_ = std::move(*ros2::LifecycleNode::create(*context_, {"/", "talker"}, {}));
      node_->trigger(ros2::TransitionId::kConfigure);
      node_->trigger(ros2::TransitionId::kActivate);
    });
    publisher_ = std::move(*ros2::RawPublisher::create(node_->node().entry(), "/chatter",
                                                       "builtin_interfaces/msg/Time", {}));
    timer_ = std::make_unique<ros2::Timer>(context_->executor(), 50ms, [this] {
      publisher_->publish(rtps::encode(ros2::msg::Time{++said_, 0}));
    });
  }
  ~Talker() {
    context_.run([&] { timer_.reset(); });
    publisher_.reset();
    context_.run([&] { node_.reset(); });
  }

 private:
  ros2::LiveContext context_;
  std::unique_ptr<ros2::LifecycleNode> node_;
  std::unique_ptr<ros2::RawPublisher> publisher_;
  std::int32_t said_ = 0;
  std::unique_ptr<ros2::Timer> timer_;
};

TEST(LossyNetwork, IsWhatIsHeldResponsibleAndNoHealthyNode) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  const TestWorld world;
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  const std::string rules =
      world.write("talker.rules",
                  "ROBOT lossy\n"
                  "COMPONENT talker NODE /talker LIFECYCLE managed\n"
                  "RULE Silent\n  POLICIES ERROR\n  TRIGGER age(/chatter) > 160ms\n"
                  "    STRATEGY talker_restart 90 10\n      ADAPTATION talker restart 5\n"
                  "RULE Lossy\n  POLICIES WARNING REPORT\n  TRIGGER loss(/chatter) > 0.1\n");
  std::unique_ptr<Talker> talker;
  {
    const TestNetwork::Visit visit(**network, TestNetwork::kRobot);
    talker = std::make_unique<Talker>();
  }
  TestProgram culprit = [&] {
    const TestNetwork::Visit visit(**network, TestNetwork::kDesk);
    return TestProgram(world, {"culprit", "run", rules, "--settle", "1", "--state-dir",
                               (world.folder() / "state").string()});
  }();
  ASSERT_TRUE(culprit.prints("talker is there")) << culprit.output();
  for (const double lost : {0.2, 0.4}) {
    (*network)->set({.lost = lost});
    std::this_thread::sleep_for(20s);  // that nothing happens takes time
  }
  ASSERT_TRUE(culprit.prints("Lossy detected")) << culprit.output();
  EXPECT_TRUE(culprit.prints("of what it sends on /chatter is lost on the way to culprit"))
      << culprit.output();
  EXPECT_THAT(culprit.output(), Not(HasSubstr("held responsible for Silent"))) << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
}

}  // namespace
}  // namespace culprit::cli
