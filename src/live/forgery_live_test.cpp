// A live robot beside a forger of its node's messages, on this computer and on another one: the node is healthy, so culprit does not act on it. If it really
// ends, it is healed.
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/joined.h"
#include "base/live_clock.h"
#include "live/test_healed_robot.h"
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

// Heals /camera: if it is gone, and if its topic is silent.
class Healer : public HealedRobot {
 public:
  Healer(const ros2::ParticipantOptions& participant, const std::vector<std::string>& camera)
      : HealedRobot(participant, text(camera)) {}

  std::uint64_t dropped() {
    return robot().link().entry().context().participant().origins().dropped();
  }

 private:
  static std::string text(const std::vector<std::string>& camera) {
    return "COMPONENT camera NODE /camera LAUNCH \"" + joined(camera, " ") + R"(" LIFECYCLE self
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
    EXPECT_TRUE(HealedRobot::comes_true([&] { return healer.resolved() > before; }))
        << healer.said();
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
  const rtps::HostileProcess stranger(eavesdropper.farewells_of(process.pid()),
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
  const rtps::HostileProcess stranger(eavesdropper.farewells_of(process.pid()),
                                      eavesdropper.ports_of(getpid()), 200ms);
  is_left_alone_and_healed(healer, process.pid());
  EXPECT_GT(healer.dropped(), 1000u);
  EXPECT_THAT(healer.said(), HasSubstr("datagrams from 10.77.0.2"));
}

TEST_F(Forgery, ThatBeganBeforeItWasLookedForEndsNoHealthyNode) {
  const ros2::PeerProcess process(camera());
  std::vector<rtps::Bytes> farewells = ros2::Eavesdropper(options).farewells_of(process.pid());
  std::vector<rtps::UdpAddress> to;  // also where nobody listens yet
  for (std::uint32_t i = 10; i < 100; ++i)
    to.push_back({{127, 0, 0, 1}, static_cast<std::uint16_t>(7400 + 250 * options.domain + i)});
  const rtps::HostileProcess stranger(farewells, to, 200ms);
  Healer healer(options, camera());
  ASSERT_TRUE(healer.sees(process.pid())) << healer.said();
  is_left_alone_and_healed(healer, process.pid());
}

}  // namespace
}  // namespace culprit::live
