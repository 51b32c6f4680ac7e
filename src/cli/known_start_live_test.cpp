// A culprit that is started again on a robot that it knows: silence is judged once all is there, not
// after the time of --settle, which the second run here is given far too much of.
#include <atomic>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/timer.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kTwoTopics = R"(
ROBOT two_topics
COMPONENT talker NODE /talker
RULE LeftSilent
  POLICIES ERROR
  TRIGGER age(/left) > 350ms
    STRATEGY left_restart 90 10
      ADAPTATION talker restart 5
RULE RightSilent
  POLICIES ERROR
  TRIGGER age(/right) > 350ms
    STRATEGY right_restart 90 10
      ADAPTATION talker restart 5
)";

// In the process of the test, so that it is the same one for all that begin.
struct KnownStartLive : testing::Test {
  KnownStartLive() {
    context.run([&] {
      node = std::move(*ros2::Node::create(*context, {"/", "talker"}));
      left.emplace(std::move(*node->create_publisher<ros2::msg::Float64>("/left")));
      right.emplace(std::move(*node->create_publisher<ros2::msg::Float64>("/right")));
    });
    talking = std::thread([this] {
      for (; !is_over; std::this_thread::sleep_for(50ms)) {
        if (left_speaks) left->publish({1});
        right->publish({1});
      }
    });
  }
  ~KnownStartLive() override {
    is_over = true;
    talking.join();
    context.run([&] {
      left.reset();
      right.reset();
      node.reset();
    });
  }

  TestProgram run(const std::string& settle) {
    return TestProgram(
        world, {"culprit", "run", rules, "--dry-run", "--settle", settle, "--state-dir", state});
  }
  bool saw_it_whole() {
    for (int i = 0; i < 300; ++i) {
      TestProgram log(world, {"culprit", "log", "--kind", "robot", "--json", "--journal", journal});
      log.wait();
      if (log.output().find("\"whole\":true") != std::string::npos) return true;
      std::this_thread::sleep_for(100ms);
    }
    return false;
  }

  TestWorld world;
  const std::string rules = world.write("two.rules", kTwoTopics);
  const std::string state = (world.folder() / "state").string();
  const std::string journal = (world.folder() / "state" / "two_topics.journal").string();
  ros2::LiveContext context{*ros2::options_from_environment()};
  std::unique_ptr<ros2::Node> node;
  std::optional<ros2::Publisher<ros2::msg::Float64>> left;
  std::optional<ros2::Publisher<ros2::msg::Float64>> right;
  std::atomic<bool> left_speaks = true;
  std::atomic<bool> is_over = false;
  std::thread talking;
};

TEST_F(KnownStartLive, FindsASilenceBeforeTheTimeOfDiscoveryIsOver) {
  {
    TestProgram first = run("5");
    ASSERT_TRUE(saw_it_whole()) << first.output();
    first.signal(SIGKILL);
    EXPECT_EQ(first.wait(), -SIGKILL);
  }
  left_speaks = false;
  TestProgram second = run("600");
  EXPECT_TRUE(second.prints("LeftSilent detected")) << second.output();
  second.signal(SIGINT);
  EXPECT_EQ(second.wait(), 0);
  EXPECT_THAT(second.output(), Not(HasSubstr("RightSilent detected")));
  TestProgram replay(world, {"culprit", "replay", journal});
  EXPECT_EQ(replay.wait(), 0) << replay.output();
  EXPECT_THAT(replay.output(), HasSubstr("all decided as recorded"));
}

}  // namespace
}  // namespace culprit::cli
