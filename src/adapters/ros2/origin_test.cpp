// A stranger that speaks in the name of a robot's node, on the same machine and for real: the
// effect on the node.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/live_test.h"
#include "ros2/peer_process.h"
#include "ros2/process_finder.h"
#include "rtps/datagram_sources.h"
#include "rtps/origins.h"
#include "rtps/test_hostile_process.h"
#include "rtps/udp_sockets.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;

// The node /camera in a process of its own, which is discovered with all its endpoints.
struct Robot {
  explicit Robot(const TestDomain& domain, LiveContext& context)
      : watcher(context), process({CULPRIT_PEER_NODE, std::to_string(domain.number()), "/camera"}) {
    is_seen = watcher.sees_node("/camera") && within([&] {
                for (const auto& each : participants()) {
                  if (each.nodes != std::vector<std::string>{"/camera"}) continue;
                  camera = each;
                  return each.endpoints.size() > 5 && each.undiscovered == 0;
                }
                return false;
              });
    for (const auto& port : ports(domain)) to.push_back({{127, 0, 0, 1}, port});
  }
  std::vector<Graph::ParticipantView> participants() {
    std::vector<Graph::ParticipantView> all;
    watcher.run([&] { all = watcher->graph().participants(); });
    return all;
  }
  template <class Done>
  bool within(Done done) {
    for (const Time end = later(live_now(), rtps::kPatience); live_now() < end;) {
      if (done()) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  }
  // Those that participants of this machine have (RTPS 2.3 §9.6.1). One reading of the kernel's table may pass over some
  // (udp_sockets.h).
  static std::set<std::uint16_t> ports(const TestDomain& domain) {
    const std::uint32_t first = 7400 + 250 * domain.number();
    std::set<std::uint16_t> all;
    for (int reading = 0; reading < 10; ++reading) {
      for (const std::uint16_t port : rtps::bound_udp_ports()) {
        if (port >= first && port < first + 250) all.insert(port);
      }
    }
    return all;
  }
  std::vector<rtps::Bytes> farewells() {
    std::vector<rtps::Guid> endpoints;
    rtps::Guid info_writer;
    for (const auto& each : camera.endpoints) endpoints.push_back(each.id);
    watcher.run([&] {
      for (std::uint32_t id = 1; id < 64; ++id) {
        rtps::Guid guid = camera.info.guid;
        guid.bytes[12] = 0, guid.bytes[13] = 0;
        guid.bytes[14] = static_cast<std::uint8_t>(id), guid.bytes[15] = 0x03;
        const rtps::EndpointInfo* endpoint = watcher->graph().endpoint(guid);
        if (endpoint != nullptr && endpoint->topic == kDiscoveryInfoTopic) info_writer = guid;
      }
    });
    return rtps::farewells(camera.info.guid, endpoints, info_writer,
                           encode_discovery_info({camera.info.guid, {}}, GidSize::kHumbleAndOlder));
  }
  bool has_lost_something() {
    return std::ranges::any_of(watcher.changes().all(), [](const GraphChange& change) {
      return std::holds_alternative<NodeLeft>(change) ||
             std::holds_alternative<EndpointLeft>(change);
    });
  }

  LiveContext& watcher;
  PeerProcess process;
  bool is_seen = false;
  Graph::ParticipantView camera;
  std::vector<rtps::UdpAddress> to;
};

Graph::Options proving() {
  Graph::Options options;
  options.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  return options;
}

TEST(Origin, FarewellsOfAStrangerDoNotRemoveANodeWhoseProcessIsProven) {
  const TestDomain domain;
  LiveContext watcher(domain.options(), proving());
  Robot robot(domain, watcher);
  ASSERT_TRUE(robot.is_seen);
  ASSERT_TRUE(watcher.sees_process("/camera", robot.process.pid()));
  rtps::Origins& origins = watcher->participant().origins();
  {
    const rtps::HostileProcess stranger(robot.farewells(), robot.to, 200ms);
    EXPECT_TRUE(robot.within([&] { return origins.dropped() > 500; }));
    EXPECT_FALSE(robot.has_lost_something());
  }
  const auto sources = origins.new_sources();
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0].pid, robot.process.pid());
  EXPECT_EQ(sources[0].user, getuid());
  // Its own goodbye counts.
  robot.process.end(SIGTERM);
  EXPECT_TRUE(watcher.sees_node_leave("/camera"));
}

TEST(Origin, FarewellsThatBeganBeforeItWasSeenDoNotKeepAProcessFromBeingProven) {
  const TestDomain domain;
  LiveContext listener(domain.options());
  Robot robot(domain, listener);
  ASSERT_TRUE(robot.is_seen);
  std::vector<rtps::UdpAddress> to;  // also where nothing listens yet
  for (std::uint32_t i = 10; i < 250; ++i)
    to.push_back({{127, 0, 0, 1}, static_cast<std::uint16_t>(7400 + 250 * domain.number() + i)});
  const rtps::HostileProcess stranger(robot.farewells(), to, 200ms);
  LiveContext watcher(domain.options(), proving());
  ASSERT_TRUE(watcher.sees_process("/camera", robot.process.pid()));
  const std::uint64_t before = watcher->participant().origins().dropped();
  EXPECT_TRUE(
      robot.within([&] { return watcher->participant().origins().dropped() > before + 500; }));
  const auto changes = watcher.changes().all();
  const auto proven = std::ranges::find_if(changes, [&](const GraphChange& change) {
    const auto* joined = std::get_if<NodeJoined>(&change);
    return joined != nullptr && joined->node.pid == robot.process.pid();
  });
  EXPECT_TRUE(std::none_of(proven, changes.end(), [](const GraphChange& change) {
    return std::holds_alternative<NodeLeft>(change);
  }));
}

// Fast DDS believes a participant that announces the end of another's endpoints.
TEST(Origin, AParticipantTellsOfItselfOnly) {
  const TestDomain domain;
  LiveContext watcher(domain.options());
  Robot robot(domain, watcher);
  ASSERT_TRUE(robot.is_seen);
  const auto stranger = Participant::create(domain.options(), [](DiscoveryEvent) {});
  ASSERT_TRUE(stranger);
  ASSERT_TRUE(robot.within([&] { return robot.participants().size() == 2; }));
  std::vector<rtps::Bytes> all = robot.farewells();
  const rtps::GuidPrefix name = (*stranger)->guid().prefix();
  for (rtps::Bytes& each : all) std::ranges::copy(name.bytes, each.begin() + 8);
  const rtps::HostileProcess sends(all, robot.to, 200ms);
  rtps::Origins& origins = watcher->participant().origins();
  EXPECT_TRUE(robot.within([&] { return origins.dropped() > 500; }));
  EXPECT_FALSE(robot.has_lost_something());
}

// Fast DDS finds their keys where the standard has none.
TEST(Origin, AParticipantTellsOfItselfOnlyInWhateverForm) {
  const TestDomain domain;
  LiveContext watcher(domain.options());
  Robot robot(domain, watcher);
  ASSERT_TRUE(robot.is_seen);
  const auto stranger = Participant::create(domain.options(), [](DiscoveryEvent) {});
  ASSERT_TRUE(stranger);
  ASSERT_TRUE(robot.within([&] { return robot.participants().size() == 2; }));
  const rtps::HostileProcess sends(
      rtps::disguised_farewells(robot.camera.info.guid, (*stranger)->guid().prefix()), robot.to,
      200ms);
  Participant& participant = watcher->participant();
  EXPECT_TRUE(robot.within(
      [&] { return participant.origins().dropped() > 20 && participant.refused().count > 20; }));
  EXPECT_FALSE(robot.has_lost_something());
}

TEST(Origin, AParticipantTellsOfItselfOnlyWithinOtherSubmessages) {
  const TestDomain domain;
  LiveContext watcher(domain.options(), proving());
  Robot robot(domain, watcher);
  ASSERT_TRUE(robot.is_seen);
  ASSERT_TRUE(watcher.sees_process("/camera", robot.process.pid()));
  const auto stranger = Participant::create(domain.options(), [](DiscoveryEvent) {});
  ASSERT_TRUE(stranger);
  ASSERT_TRUE(robot.within([&] { return robot.participants().size() == 2; }));
  const rtps::HostileProcess sends(
      rtps::smuggled_farewells(robot.camera.info.guid, (*stranger)->guid().prefix()), robot.to,
      200ms);
  EXPECT_TRUE(robot.within([&] { return watcher->participant().origins().dropped() > 20; }));
  EXPECT_FALSE(robot.has_lost_something());
}

TEST(Origin, FarewellsOfAStrangerRemoveANodeWhoseProcessIsNotKnown) {
  const TestDomain domain;
  LiveContext watcher(domain.options());
  Robot robot(domain, watcher);
  ASSERT_TRUE(robot.is_seen);
  const rtps::HostileProcess stranger(robot.farewells(), robot.to, 200ms);
  EXPECT_TRUE(watcher.sees_node_leave("/camera"));
}

}  // namespace
}  // namespace culprit::ros2
