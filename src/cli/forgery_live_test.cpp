// The whole program beside somebody who speaks in the name of the robot's node, from this computer and from another
// one: the node is healthy, so nothing is done to it. If it really ends, it is healed.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "cli/test_network.h"
#include "exemplars/sunset/node_process.h"
#include "ros2/discovery_info.h"
#include "ros2/options.h"
#include "ros2/participant.h"
#include "rtps/test_hostile_process.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCameraRules = R"(
ROBOT forged
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/managed_subsystem/rgb_camera) > 3s
    STRATEGY camera_replace 90 10
      ADAPTATION camera redeploy 5
)";

template <class Done>
bool comes_true(Done done, Duration patience = TestProgram::kPatience) {
  for (const Time end = later(live_now(), patience); !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

// What anybody in the domain learns by listening: who is there, with what, and where.
class Listener {
 public:
  Listener()
      : participant_(*ros2::Participant::create(
            *ros2::options_from_environment(),
            [this](const ros2::DiscoveryEvent& event) { note(event); })) {}

  // Of the process with this number: all that takes its node away from those who believe it.
  std::vector<ros2::Bytes> farewells_of(int pid) {
    EXPECT_TRUE(comes_true([&] {
      const std::lock_guard lock(mutex_);
      return participants_.contains(pid) && endpoints_of(pid).size() > 12;
    }));
    const std::lock_guard lock(mutex_);
    const ros2::Guid guid = participants_[pid].guid;
    return ros2::farewells(guid, endpoints_of(pid), info_writers_[guid.prefix()],
                           ros2::encode_discovery_info({guid, {}}, ros2::GidSize::kHumbleAndOlder));
  }
  // Where the process listens: for discovery, and for samples.
  std::vector<ros2::UdpAddress> ports_of(int pid) {
    EXPECT_TRUE(comes_true([&] {
      const std::lock_guard lock(mutex_);
      return participants_.contains(pid);
    }));
    const std::lock_guard lock(mutex_);
    std::vector<ros2::UdpAddress> all = participants_[pid].metatraffic;
    for (ros2::UdpAddress each : participants_[pid].metatraffic) {
      ++each.port;
      all.push_back(each);
    }
    return all;
  }

 private:
  void note(const ros2::DiscoveryEvent& event) {
    const std::lock_guard lock(mutex_);
    if (const auto* info = std::get_if<ros2::ParticipantInfo>(&event)) {
      participants_[info->pid] = *info;
    } else if (const auto* endpoint = std::get_if<ros2::EndpointInfo>(&event)) {
      endpoints_.push_back(endpoint->guid);
      if (endpoint->topic == ros2::kDiscoveryInfoTopic && !endpoint->guid.is_reader())
        info_writers_[endpoint->guid.prefix()] = endpoint->guid;
    }
  }
  std::vector<ros2::Guid> endpoints_of(int pid) {
    std::vector<ros2::Guid> all;
    for (const ros2::Guid& each : endpoints_) {
      if (each.prefix() == participants_[pid].guid.prefix()) all.push_back(each);
    }
    return all;
  }

  std::mutex mutex_;
  std::map<int, ros2::ParticipantInfo> participants_;  // by the process that they say they are
  std::vector<ros2::Guid> endpoints_;
  std::map<ros2::GuidPrefix, ros2::Guid> info_writers_;
  std::unique_ptr<ros2::Participant> participant_;
};

struct Forgery : testing::Test {
  ~Forgery() override {
    for (const int pid : cameras()) kill(pid, SIGKILL);
  }
  std::vector<std::string> run() {
    return {"culprit", "run",         world.write("forged.rules", kCameraRules), "--settle",
            "1",       "--state-dir", (world.folder() / "state").string()};
  }
  static std::vector<int> cameras() {
    return sunset::processes_of(sunset::Member::kCamera, ros2::options_from_environment()->domain);
  }
  // During the attack: nothing is done to the camera; and when it is killed, another one comes.
  void is_left_alone_and_healed(const TestProgram& culprit, int camera) {
    std::this_thread::sleep_for(8s);
    EXPECT_EQ(cameras(), std::vector<int>{camera}) << culprit.output();
    EXPECT_THAT(culprit.output(), Not(HasSubstr("redeploy camera"))) << "a healthy node";
    const Time killed = live_now();
    kill(camera, SIGKILL);
    EXPECT_TRUE(culprit.prints("resolved by camera_redeploy")) << culprit.output();
    RecordProperty("healed_after_ms",
                   std::to_string((live_now() - killed) / std::chrono::milliseconds(1)));
    EXPECT_EQ(cameras().size(), 1u);
  }

  TestWorld world;
};

TEST_F(Forgery, OfAnotherProcessOfThisComputerEndsNoHealthyNode) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram culprit(world, run());
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  Listener listener;
  const ros2::HostileProcess stranger(listener.farewells_of(camera.pid()),
                                      listener.ports_of(culprit.pid()), 200ms);
  EXPECT_TRUE(culprit.prints("speak for /managed_subsystem/camera (process " +
                             std::to_string(camera.pid()) + ")"))
      << culprit.output();
  is_left_alone_and_healed(culprit, camera.pid());
}

TEST_F(Forgery, FromAnotherComputerEndsNoHealthyNode) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  std::optional<TestNetwork::Visit> here(std::in_place, **network, TestNetwork::kRobot);
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram culprit(world, run());
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  here.reset();
  here.emplace(**network, TestNetwork::kDesk);
  Listener listener;
  const ros2::HostileProcess stranger(listener.farewells_of(camera.pid()),
                                      listener.ports_of(culprit.pid()), 200ms);
  EXPECT_TRUE(culprit.prints("datagrams from 10.77.0.2")) << culprit.output();
  is_left_alone_and_healed(culprit, camera.pid());
}

// The process of the camera is not proven then, or later.
TEST_F(Forgery, ThatBeganBeforeCulpritEndsNoHealthyNode) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  std::optional<Listener> listener(std::in_place);
  const std::vector<ros2::Bytes> forged = listener->farewells_of(camera.pid());
  const std::uint32_t first = 7400 + 250 * ros2::options_from_environment()->domain + 10;
  std::vector<ros2::UdpAddress> to;
  for (std::uint32_t i = 0; i < 16; ++i)
    to.push_back({{127, 0, 0, 1}, static_cast<std::uint16_t>(first + i)});
  const ros2::HostileProcess stranger(forged, to, 200ms);
  const TestProgram culprit(world, run());
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  is_left_alone_and_healed(culprit, camera.pid());
}

}  // namespace
}  // namespace culprit::cli
