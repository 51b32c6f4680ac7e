// Attackers that know RTPS, and send what no participant sends: lies in the name of the camera, and what should break a
// reader of datagrams.
#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstdint>
#include <iterator>
#include <linux/if_ether.h>
#include <netinet/ip.h>
#include <random>
#include <span>
#include <sys/socket.h>
#include <unistd.h>

#include <net/if.h>
#include <netpacket/packet.h>

#include "base/lifecycle_state.h"
#include "base/live_clock.h"
#include "cli/test_attacks.h"
#include "ros2/discovery_info.h"
#include "ros2/messages.h"
#include "rtps/test_hostile_process.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using rtps::Bytes;
using rtps::Guid;
using rtps::TestDatagram;
using rtps::TestParameters;

Ongoing sends(const Target& target, const std::vector<Bytes>& datagrams,
              std::chrono::milliseconds pause = 200ms) {
  return std::make_shared<rtps::HostileProcess>(datagrams, target.ports(), pause);
}

// ---- in the camera's name

Ongoing endpoints_end(const Target& target) {
  const auto camera = target.eavesdropper->of(target.camera);
  std::vector<Guid> all;
  for (const auto& each : camera.endpoints) all.push_back(each.guid);
  return sends(target, rtps::farewells_of_endpoints(camera.participant, all));
}
// The writer of the topic that a rule watches.
Ongoing picture_writer_ends(const Target& target) {
  const auto camera = target.eavesdropper->of(target.camera);
  std::vector<Guid> all;
  for (const auto& each : camera.endpoints) {
    if (!each.guid.is_reader() && each.topic.ends_with("rgb_camera")) all.push_back(each.guid);
  }
  return sends(target, rtps::farewells_of_endpoints(camera.participant, all));
}
Ongoing good_byes(const Target& target) {
  return sends(target, {rtps::farewell_of(target.eavesdropper->of(target.camera).participant)});
}
Ongoing holds_no_node(const Target& target) {
  const auto camera = target.eavesdropper->of(target.camera);
  const Bytes info =
      ros2::encode_discovery_info({camera.participant, {}}, ros2::GidSize::kHumbleAndOlder);
  return sends(target, rtps::forged_info(camera.participant, camera.info_writer, info));
}
Ongoing all_farewells(const Target& target) {
  return sends(target, target.eavesdropper->farewells_of(target.camera));
}
Ongoing all_farewells_all_the_time(const Target& target) {
  return sends(target, target.eavesdropper->farewells_of(target.camera), 5ms);
}

// ---- of the camera, in another's name

Ongoing disguised_farewells(const Target& target) {
  const Guid camera = target.eavesdropper->of(target.camera).participant;
  std::vector<Bytes> all = {rtps::announcement_of(5)};
  std::ranges::copy(rtps::disguised_farewells(camera, rtps::made_up(5).prefix()),
                    std::back_inserter(all));
  return sends(target, all, 20ms);
}
Ongoing smuggled_farewells(const Target& target) {
  const Guid camera = target.eavesdropper->of(target.camera).participant;
  std::vector<Bytes> all = {rtps::announcement_of(5)};
  std::ranges::copy(rtps::smuggled_farewells(camera, rtps::made_up(5).prefix()),
                    std::back_inserter(all));
  return sends(target, all, 20ms);
}

// ---- in the name of the camera and of culprit

Guid writer_of(const Target& target, const std::string& topic) {
  for (const auto& each : target.eavesdropper->of(target.camera).endpoints) {
    if (!each.guid.is_reader() && each.topic.ends_with(topic)) return each.guid;
  }
  return target.eavesdropper->of(target.camera).info_writer;
}
std::vector<Bytes> samples(const Guid& writer, const Bytes& payload) {
  std::vector<Bytes> all;
  for (const std::int64_t number : {1, 10, 100, 1000, 10'000, 1'000'000})
    all.push_back(TestDatagram(writer.prefix()).sample(writer, number, payload).bytes());
  return all;
}
Ongoing diagnostics_in_its_name(const Target& target) {
  ros2::msg::DiagnosticArray array;
  array.status = {{2, "camera_heartbeat", "broken", "camera", {}}};
  return sends(target, samples(writer_of(target, "/diagnostics"), rtps::encode(array)), 20ms);
}
Ongoing transitions_in_its_name(const Target& target) {
  ros2::msg::TransitionEvent event;
  event.goal_state.id = static_cast<std::uint8_t>(LifecycleState::kInactive);
  return sends(target, samples(writer_of(target, "/transition_event"), rtps::encode(event)), 20ms);
}
// The writers of the camera and of culprit itself, those that announce others too.
std::vector<Guid> writers_of_both(const Target& target) {
  std::vector<Guid> all;
  for (const int process : {target.camera, target.culprit}) {
    const auto learned = target.eavesdropper->of(process);
    for (const auto& each : learned.endpoints)
      if (!each.guid.is_reader()) all.push_back(each.guid);
    for (const std::uint8_t entity : {3, 4}) {
      Guid guid = learned.participant;
      guid.bytes[13] = 0, guid.bytes[14] = entity, guid.bytes[15] = 0xc2;
      all.push_back(guid);
    }
  }
  return all;
}
Ongoing absurd_heartbeats(const Target& target) {
  constexpr std::int64_t kAbsurd = std::int64_t{1} << 60;
  std::vector<Bytes> all;
  for (const Guid& each : writers_of_both(target)) {
    const TestDatagram from(each.prefix());
    all.push_back(TestDatagram(from).gap(each, 1, kAbsurd).bytes());
    all.push_back(TestDatagram(from).heartbeat(each, kAbsurd, kAbsurd, 1 << 30).bytes());
    all.push_back(TestDatagram(from).heartbeat(each, 1, kAbsurd, 1 << 29).bytes());
    all.push_back(TestDatagram(from).data(each, kAbsurd).bytes());
  }
  return sends(target, all, 20ms);
}
// Those of a participant that is there pass the check of their origin.
Ongoing absurd_ranges(const Target& target) {
  std::vector<Guid> writers = writers_of_both(target);
  for (const std::uint8_t entity : {3, 4}) writers.push_back(rtps::made_up(6, 0, entity));
  std::vector<Bytes> all = {rtps::announcement_of(6)};
  for (const Guid& each : writers)
    std::ranges::copy(rtps::absurd_ranges(each), std::back_inserter(all));
  return sends(target, all);
}
// Each would take 20 MB.
Ongoing huge_fragments(const Target& target) {
  std::vector<Bytes> all;
  for (const Guid& each : writers_of_both(target)) {
    for (int i = 0; i < 20; ++i)
      all.push_back(TestDatagram(each.prefix()).fragment(each, 2 + i, 1, 1000, 20'000'000).bytes());
  }
  return sends(target, all, 20ms);
}

// The datagrams that the camera sent: root can listen to loopback.
std::vector<Bytes> recorded(const rtps::GuidPrefix& sender, Duration length) {
  std::vector<Bytes> all;
  const int descriptor =
      socket(AF_PACKET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, htons(ETH_P_IP));
  if (descriptor < 0) return all;
  std::array<std::uint8_t, 65'536> packet{};
  constexpr std::size_t kHeaders = 20 + 8;  // IP, UDP
  for (const Time end = later(live_now(), length); live_now() < end && all.size() < 2000;) {
    const ssize_t size = recv(descriptor, packet.data(), packet.size(), 0);
    if (size < 0 && errno == EAGAIN) usleep(1000);
    if (size < static_cast<ssize_t>(kHeaders + 20) || packet[9] != IPPROTO_UDP) continue;
    const std::span rtps(packet.begin() + kHeaders, packet.begin() + size);
    const bool is_it = rtps[0] == 'R' && rtps[1] == 'T' &&
                       std::equal(sender.bytes.begin(), sender.bytes.end(), rtps.begin() + 8);
    if (is_it) all.emplace_back(rtps.begin(), rtps.end());
  }
  close(descriptor);
  return all;
}
Ongoing replays(const Target& target) {
  const auto participant = target.eavesdropper->of(target.camera).participant;
  return sends(target, recorded(participant.prefix(), 1500ms), 50ms);
}

// ---- in nobody's name

Ongoing a_thousand_participants(const Target& target) {
  std::vector<Bytes> all;
  for (std::uint16_t i = 0; i < 1100; ++i) all.push_back(rtps::announcement_of(i));
  return sends(target, all, 500ms);
}
Ongoing ten_thousand_endpoints(const Target& target) {
  std::vector<Bytes> all = {rtps::announcement_of(7)};
  const Guid announcer = rtps::made_up(7, 0, 3);
  for (std::int64_t i = 1; i <= 10'000; ++i) {
    Guid writer = rtps::made_up(7);
    writer.bytes[12] = 1, writer.bytes[13] = static_cast<std::uint8_t>(i >> 8);
    writer.bytes[14] = static_cast<std::uint8_t>(i), writer.bytes[15] = 3;
    const Bytes said = TestParameters()
                           .endpoint(writer)
                           .add(0x05, "rt/flood_" + std::to_string(i))
                           .add(0x07, "std_msgs::msg::dds_::String_")
                           .end();
    all.push_back(TestDatagram(writer.prefix()).announcement(announcer, i, said).bytes());
  }
  return sends(target, all, 1000ms);
}
Ongoing random_bytes(const Target& target) {
  std::mt19937 random(1);
  std::vector<Bytes> all;
  for (int i = 0; i < 1000; ++i) {
    Bytes bytes(random() % 1400);
    for (std::uint8_t& each : bytes) each = static_cast<std::uint8_t>(random());
    all.push_back(std::move(bytes));
  }
  return sends(target, all, 20ms);
}
// Right to the middle of a submessage, and wrong from there on.
Ongoing malformed(const Target& target) {
  std::mt19937 random(2);
  std::vector<Bytes> right = target.eavesdropper->farewells_of(target.camera);
  right.push_back(rtps::announcement_of(3));
  std::vector<Bytes> all;
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes = right[random() % right.size()];
    if (i % 2 == 0) bytes.resize(random() % bytes.size());
    for (int n = 0; n < 4 && bytes.size() > 20; ++n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    all.push_back(std::move(bytes));
  }
  return sends(target, all, 20ms);
}
Ongoing endless_submessages(const Target& target) {
  TestDatagram many(rtps::made_up(9).prefix());
  for (int i = 0; i < 8000; ++i) many.submessage(0x01, 0, {});
  TestDatagram unknown(rtps::made_up(9).prefix());
  for (int i = 0; i < 256; ++i)
    unknown.submessage(static_cast<std::uint8_t>(i), 0xff, Bytes(60, 0xff));
  return sends(target, {many.bytes(), unknown.bytes()}, 5ms);
}
// As many as the machine sends.
Ongoing as_many_as_it_can(const Target& target) {
  return sends(target, {rtps::announcement_of(1), Bytes(1400, 0), Bytes(20, 'R')}, 0ms);
}

}  // namespace

std::vector<Attack> attacks_by_datagrams() {
  const auto there = Place::kElsewhere;
  return {
      {"picture_writer_ends", picture_writer_ends},
      {"picture_writer_ends_from_elsewhere", picture_writer_ends, there},
      {"endpoints_end", endpoints_end},
      {"endpoints_end_from_elsewhere", endpoints_end, there},
      {"good_byes", good_byes, Place::kHere, true},
      {"good_byes_from_elsewhere", good_byes, there},
      {"holds_no_node", holds_no_node},
      {"holds_no_node_from_elsewhere", holds_no_node, there},
      {"all_farewells", all_farewells},
      {"all_farewells_from_elsewhere", all_farewells, there},
      {"all_farewells_all_the_time", all_farewells_all_the_time},
      {"diagnostics_in_its_name", diagnostics_in_its_name},
      {"diagnostics_in_its_name_from_elsewhere", diagnostics_in_its_name, there},
      {"transitions_in_its_name", transitions_in_its_name},
      {"transitions_in_its_name_from_elsewhere", transitions_in_its_name, there},
      {"absurd_heartbeats", absurd_heartbeats, Place::kHere, true,
       "which does not send from there"},
      {"absurd_heartbeats_from_elsewhere", absurd_heartbeats, there},
      {"absurd_ranges", absurd_ranges},
      {"absurd_ranges_from_elsewhere", absurd_ranges, there},
      {"disguised_farewells", disguised_farewells},
      {"disguised_farewells_from_elsewhere", disguised_farewells, there},
      {"smuggled_farewells", smuggled_farewells},
      {"smuggled_farewells_from_elsewhere", smuggled_farewells, there},
      {"huge_fragments", huge_fragments, Place::kHere, true},
      {"huge_fragments_from_elsewhere", huge_fragments, there},
      {"replays", replays, Place::kHere, true},
      {"a_thousand_participants", a_thousand_participants},
      {"a_thousand_participants_from_elsewhere", a_thousand_participants, there},
      {"ten_thousand_endpoints", ten_thousand_endpoints},
      {"ten_thousand_endpoints_from_elsewhere", ten_thousand_endpoints, there},
      {"random_bytes", random_bytes},
      {"malformed", malformed, Place::kHere, true},
      {"malformed_from_elsewhere", malformed, there},
      {"endless_submessages", endless_submessages},
      {"as_many_as_it_can", as_many_as_it_can},
      {"as_many_as_it_can_from_elsewhere", as_many_as_it_can, there},
  };
}

}  // namespace culprit::cli
