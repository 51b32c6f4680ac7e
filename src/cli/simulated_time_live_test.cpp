// A simulated robot whose time stands still, jumps and goes on (`culprit run --use-sim-time`).
#include <atomic>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/publisher.h"
#include "ros2/timer.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// Publishes /clock fifty times a second.
class Simulator {
 public:
  Simulator() : context_(*ros2::options_from_environment()) {
    context_.run([&] {
      node_ = std::move(*ros2::LifecycleNode::create(*context_, {"/", "simulator"}, {}));
    });
    publisher_ = std::move(*ros2::RawPublisher::create(node_->node().entry(), "/clock",
                                                       "rosgraph_msgs/msg/Clock", {}));
    timer_ = std::make_unique<ros2::Timer>(context_->executor(), 20ms, [this] { tick(); });
  }
  ~Simulator() {
    context_.run([&] { timer_.reset(); });
    publisher_.reset();
    context_.run([&] { node_.reset(); });
  }

  std::atomic<bool> runs = true;
  std::atomic<std::int32_t> day = 1;

 private:
  void tick() {
    if (runs) shown_ += 20ms;
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(shown_);
    publisher_->publish(rtps::encode(ros2::msg::Time{
        static_cast<std::int32_t>(whole.count()) + day * 86'400,
        static_cast<std::uint32_t>((shown_ - whole) / std::chrono::nanoseconds(1))}));
  }

  ros2::LiveContext context_;
  std::unique_ptr<ros2::LifecycleNode> node_;
  std::unique_ptr<ros2::RawPublisher> publisher_;
  std::chrono::nanoseconds shown_{};
  std::unique_ptr<ros2::Timer> timer_;
};

TEST(SimulatedTime, ThatStandsStillOrJumpsReplacesNobody) {
  const TestWorld world;
  Simulator simulator;
  TestProgram camera(world, {"sunset-node", "camera"});
  const std::string rules = world.write(
      "camera.rules",
      "ROBOT simulated\n"
      "COMPONENT camera NODE /managed_subsystem/camera LAUNCH \"sunset-node camera\"\n"
      "RULE Dead\n  POLICIES ERROR\n  TRIGGER age(/managed_subsystem/rgb_camera) > 700ms\n"
      "    STRATEGY camera_redeploy 90 10\n      ADAPTATION camera redeploy 5\n");
  TestProgram culprit(world, {"culprit", "run", rules, "--use-sim-time", "--settle", "1",
                              "--state-dir", (world.folder() / "state").string()});
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();

  simulator.runs = false;
  ASSERT_TRUE(culprit.prints("the simulated time stands still")) << culprit.output();
  kill(camera.pid(), SIGSTOP);
  std::this_thread::sleep_for(3s);  // that nothing happens takes time
  kill(camera.pid(), SIGCONT);
  simulator.runs = true;
  simulator.day = 3;
  const auto goes_on = [&] {
    const std::string said = culprit.output();
    const std::size_t on = said.rfind("messages again");
    return on != std::string::npos && on > said.rfind("stands still");
  };
  for (const Time end = live_now() + TestProgram::kPatience; !goes_on();) {
    ASSERT_LT(live_now(), end) << culprit.output();
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_THAT(culprit.output(), Not(HasSubstr("Dead detected"))) << culprit.output();

  kill(camera.pid(), SIGKILL);
  EXPECT_TRUE(culprit.prints("Dead detected")) << culprit.output();
  EXPECT_TRUE(culprit.prints("camera is held responsible for Dead")) << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
}

}  // namespace
}  // namespace culprit::cli
