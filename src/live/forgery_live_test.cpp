// A live robot beside a forger of its node's messages, on this computer and on another one: the node is healthy, so culprit does not act on it. If it really
// ends, it is healed.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "knowledge/describe.h"
#include "language/checker.h"
#include "live/live_robot.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/live_test.h"
#include "ros2/peer_process.h"
#include "ros2/test_eavesdropper.h"
#include "rtps/origins.h"
#include "rtps/test_hostile_process.h"
#include "rtps/test_network.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

template <class Done>
bool comes_true(Done done) {
  for (const Time end = later(live_now(), ros2::kPatience); !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

// Heals /camera: if it is gone, and if its topic is silent.
class Healer {
 public:
  Healer(const ros2::ParticipantOptions& participant, const std::vector<std::string>& camera)
      : rules_(*check(Source("test.rules", text(camera))).rules) {
    LiveRobot::Options options;
    options.link.participant = participant;
    options.supervisor.log_folder = folder_.path();
    auto robot = LiveRobot::open(rules_, std::move(options));
    if (!robot) throw std::runtime_error(robot.error());
    robot_ = std::move(*robot);
    Manager::Options how;
    how.start = live_now();
    how.discovery = 1s;
    manager_.emplace(rules_, std::make_unique<BayesPlanner>(), how);
    runtime_.emplace(*manager_, *robot_);
    runtime_->on_events = [this](std::span<const Event> events) { note(events); };
    runtime_->on_step = [this](const Runtime::Step& step) { note(step.observations); };
    thread_ = std::thread([this] { runtime_->run(is_over_); });
  }
  ~Healer() {
    is_over_ = true;
    robot_->interrupt();
    thread_.join();
    robot_.reset();
    for (const int pid : seen_) kill(pid, SIGKILL);
  }
  Healer(const Healer&) = delete;

  bool sees(int pid) {
    return comes_true([&] {
      const std::lock_guard lock(mutex_);
      return std::ranges::find(seen_, pid) != seen_.end();
    });
  }
  std::uint64_t dropped() {
    return robot_->link().entry().context().participant().origins().dropped();
  }
  std::string said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  int detected() {
    const std::lock_guard lock(mutex_);
    return detected_;
  }
  int resolved() {
    const std::lock_guard lock(mutex_);
    return resolved_;
  }

 private:
  static std::string text(const std::vector<std::string>& camera) {
    std::string launch;
    for (const std::string& word : camera) launch += (launch.empty() ? "" : " ") + word;
    return "COMPONENT camera NODE /camera LAUNCH \"" + launch + R"(" LIFECYCLE self
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/camera/value) > 3s
    STRATEGY camera_replace 90 10
      ADAPTATION camera redeploy 5
)";
  }
  void note(std::span<const Event> events) {
    const std::lock_guard lock(mutex_);
    for (const Event& event : events) {
      said_ += describe(event, rules_) + "\n";
      detected_ += std::holds_alternative<FailureDetected>(event.what);
      resolved_ += std::holds_alternative<FailureResolved>(event.what);
    }
  }
  void note(const std::vector<Observation>& observations) {
    const std::lock_guard lock(mutex_);
    for (const Observation& observation : observations) {
      const auto* appeared = std::get_if<NodeAppeared>(&observation.what);
      if (appeared != nullptr && appeared->node == "/camera" && appeared->pid != 0)
        seen_.push_back(appeared->pid);
    }
  }

  const test::TestFolder folder_;
  const RuleSet rules_;
  std::unique_ptr<LiveRobot> robot_;
  std::optional<Manager> manager_;
  std::optional<Runtime> runtime_;
  std::mutex mutex_;
  std::string said_;
  int detected_ = 0;
  int resolved_ = 0;
  std::vector<int> seen_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

struct Forgery : testing::Test {
  std::vector<std::string> camera() const {
    std::vector<std::string> words = {CULPRIT_PEER_NODE, std::to_string(options.domain)};
    if (options.reach == ros2::Reach::kSubnet) words.emplace_back("--subnet");
    words.emplace_back("--active");
    words.emplace_back("/camera");
    return words;
  }
  // During the attack.
  void is_left_alone_and_healed(Healer& healer, int camera) {
    std::this_thread::sleep_for(8s);
    EXPECT_EQ(kill(camera, 0), 0);
    EXPECT_EQ(healer.detected(), 0) << "of a healthy node:\n" << healer.said();
    const int before = healer.resolved();
    const Time killed = live_now();
    kill(camera, SIGKILL);
    EXPECT_TRUE(comes_true([&] { return healer.resolved() > before; })) << healer.said();
    RecordProperty("healed_after_ms",
                   std::to_string((live_now() - killed) / std::chrono::milliseconds(1)));
  }

  ros2::TestDomain domain;
  ros2::ParticipantOptions options = domain.options();
};

TEST_F(Forgery, OfAnotherProcessOfThisComputerEndsNoHealthyNode) {
  const ros2::PeerProcess process(camera());
  Healer healer(options, camera());
  ASSERT_TRUE(healer.sees(process.pid())) << healer.said();
  ros2::Eavesdropper eavesdropper(options);
  const ros2::HostileProcess stranger(eavesdropper.farewells_of(process.pid()),
                                      eavesdropper.ports_of(getpid()), 200ms);
  is_left_alone_and_healed(healer, process.pid());
  EXPECT_GT(healer.dropped(), 1000u);
  EXPECT_THAT(healer.said(),
              HasSubstr("speak for /camera (process " + std::to_string(process.pid()) + ")"));
}

TEST_F(Forgery, FromAnotherComputerEndsNoHealthyNode) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  options.reach = ros2::Reach::kSubnet;
  std::optional<TestNetwork::Visit> here(std::in_place, **network, TestNetwork::kRobot);
  const ros2::PeerProcess process(camera());
  Healer healer(options, camera());
  ASSERT_TRUE(healer.sees(process.pid())) << healer.said();
  here.reset();
  here.emplace(**network, TestNetwork::kDesk);
  ros2::Eavesdropper eavesdropper(options);
  const ros2::HostileProcess stranger(eavesdropper.farewells_of(process.pid()),
                                      eavesdropper.ports_of(getpid()), 200ms);
  is_left_alone_and_healed(healer, process.pid());
  EXPECT_GT(healer.dropped(), 1000u);
  EXPECT_THAT(healer.said(), HasSubstr("datagrams from 10.77.0.2"));
}

TEST_F(Forgery, ThatBeganBeforeItWasLookedForEndsNoHealthyNode) {
  const ros2::PeerProcess process(camera());
  std::vector<ros2::Bytes> farewells = ros2::Eavesdropper(options).farewells_of(process.pid());
  std::vector<ros2::UdpAddress> to;  // also where nobody listens yet
  for (std::uint32_t i = 10; i < 100; ++i)
    to.push_back({{127, 0, 0, 1}, static_cast<std::uint16_t>(7400 + 250 * options.domain + i)});
  const ros2::HostileProcess stranger(farewells, to, 200ms);
  Healer healer(options, camera());
  ASSERT_TRUE(healer.sees(process.pid())) << healer.said();
  is_left_alone_and_healed(healer, process.pid());
}

}  // namespace
}  // namespace culprit::live
