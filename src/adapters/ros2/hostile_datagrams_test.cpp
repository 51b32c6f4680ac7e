// Datagrams that no participant sends, thrown at a live one: it goes on hearing, stays small, and
// can be ended.
#include <arpa/inet.h>
#include <fstream>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/hearing.h"
#include "ros2/live_test.h"
#include "rtps/test_hostile_process.h"

namespace culprit::ros2 {
namespace {

constexpr std::int64_t kFarAhead = std::int64_t{1} << 60;

std::size_t resident_bytes() {
  std::size_t total = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Sends to the ports at which one participant listens: for discovery, and the next one for samples.
class Attacker {
 public:
  ~Attacker() { close(socket_); }
  Attacker() = default;
  Attacker(const Attacker&) = delete;

  void aim(const ParticipantInfo& victim) { port_ = victim.metatraffic.front().port; }
  void send(const rtps::Bytes& bytes) const {
    for (const int port : {port_, port_ + 1}) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      to.sin_port = htons(static_cast<std::uint16_t>(port));
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
    }
  }

 private:
  int port_ = 0;
  const int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
};

class HostileDatagrams : public testing::Test {
 protected:
  HostileDatagrams() {
    EXPECT_TRUE(seen.wait_for_one([this](const ParticipantInfo& info) {
      const bool is_victim = info.guid == victim->guid() && !info.metatraffic.empty();
      if (is_victim) attacker.aim(info);
      return is_victim;
    }));
    writer = std::move(*robot->create_writer({"t", "T", rtps::qos::kDiscoveryInfoWriter, "", {}}));
    reader = std::move(*victim->create_reader(
        {"t", "T", rtps::qos::kDiscoveryInfoReader, PayloadUse::kWhole, "", {}},
        [this](const Sample& sample) { samples.add(sample.identity.sequence); }));
    EXPECT_TRUE(speaks());
  }

  // The robot's writers, as the attacker knows them: its own, and those that announce endpoints.
  std::vector<rtps::Guid> writers() const {
    std::vector<rtps::Guid> all{writer->guid()};
    for (const std::uint8_t entity : {3, 4}) {
      rtps::Guid guid = robot->guid();
      guid.bytes[13] = 0, guid.bytes[14] = entity, guid.bytes[15] = 0xc2;
      all.push_back(guid);
    }
    return all;
  }
  // Whether the robot's samples arrive.
  bool speaks() {
    const auto sequence = writer->write(kSmallPayload);
    return sequence && samples.wait_for_one([&](std::int64_t heard) { return heard == *sequence; });
  }
  // Whether another writer of the robot is found.
  bool discovers() {
    rtps::EventLog<int> matches;
    const std::string topic = "topic" + std::to_string(++topics_);
    const auto own = victim->create_reader({topic, "T", rtps::qos::kSensorData, PayloadUse::kWhole,
                                            "", [&](const rtps::Guid&, Match) { matches.add(1); }},
                                           [](const Sample&) {});
    const auto other = robot->create_writer({topic, "T", {}, "", {}});
    return own && other && matches.wait_for_count(1);
  }

  rtps::EventLog<std::int64_t> samples;
  TestDomain domain;
  rtps::EventLog<ParticipantInfo> seen;  // by the robot
  std::unique_ptr<Participant> robot = join(domain, [this](const DiscoveryEvent& event) {
    if (const auto* info = std::get_if<ParticipantInfo>(&event)) seen.add(*info);
  });
  std::unique_ptr<Participant> victim = join(domain);
  std::unique_ptr<Writer> writer;
  std::unique_ptr<Reader> reader;
  Attacker attacker;

 private:
  int topics_ = 0;
};

TEST_F(HostileDatagrams, AbsurdSequenceNumbersMakeNobodyDeaf) {
  for (const rtps::Guid& each : writers()) {
    attacker.send(rtps::TestDatagram(each.prefix()).gap(each, 1, kFarAhead).bytes());
    attacker.send(
        rtps::TestDatagram(each.prefix()).heartbeat(each, kFarAhead, kFarAhead, 1 << 30).bytes());
    attacker.send(rtps::TestDatagram(each.prefix()).heartbeat(each, 1, kFarAhead, 1 << 29).bytes());
    attacker.send(rtps::TestDatagram(each.prefix()).data(each, kFarAhead).bytes());
  }
  EXPECT_TRUE(speaks());
  EXPECT_TRUE(discovers());
  EXPECT_TRUE(speaks()) << "by now all of them were looked at";
  EXPECT_GE(victim->refused().count, 12u);
}

TEST_F(HostileDatagrams, AbsurdRangesMakeNobodyDeaf) {
  for (const rtps::Guid& each : writers()) {
    for (const rtps::Bytes& datagram : rtps::absurd_ranges(each)) attacker.send(datagram);
  }
  EXPECT_TRUE(speaks());
  EXPECT_TRUE(discovers());
  EXPECT_TRUE(speaks()) << "by now all of them were looked at";
}

TEST_F(HostileDatagrams, FragmentsOfHugeSamplesTakeNoMemory) {
  const std::size_t before = resident_bytes();
  for (const rtps::Guid& each : writers()) {
    for (std::int64_t sequence = 2; sequence < 252; ++sequence)
      attacker.send(
          rtps::TestDatagram(each.prefix()).fragment(each, sequence, 1, 1000, 20'000'000).bytes());
  }
  EXPECT_TRUE(discovers());
  EXPECT_LT(resident_bytes(), before + (64u << 20));
}

TEST_F(HostileDatagrams, FragmentsWithinTheBudgetTakeNoMoreThanIt) {
  const std::size_t before = resident_bytes();
  for (const rtps::Guid& each : writers()) {
    for (std::int64_t sequence = 2; sequence < 252; ++sequence)
      attacker.send(
          rtps::TestDatagram(each.prefix()).fragment(each, sequence, 1, 1000, 1'000'000).bytes());
  }
  EXPECT_TRUE(discovers());
  EXPECT_LT(resident_bytes(), before + (64u << 20));
}

// Each takes the middleware milliseconds on the thread that receives.
TEST_F(HostileDatagrams, ParticipantsThatOneSourceMakesUpComeInSlowly) {
  for (std::uint16_t i = 0; i < 1100; ++i) {
    attacker.send(rtps::announcement_of(i));
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(discovers());
  EXPECT_TRUE(speaks());
  EXPECT_GE(victim->refused().count, 1u);
  EXPECT_EQ(victim->refused().why, "one source introduces too many participants");
}

TEST_F(HostileDatagrams, ParticipantsThatAKnownOneMakesUpComeInSlowly) {
  constexpr std::size_t kPrefix = 8;
  constexpr std::size_t kNumber = 40;  // the low half of the sample's, little endian
  for (std::uint16_t i = 0; i < 1100; ++i) {
    rtps::Bytes datagram = rtps::announcement_of(i);
    std::ranges::copy(robot->guid().prefix().bytes, datagram.begin() + kPrefix);
    datagram[kNumber] = static_cast<std::uint8_t>(i + 2);
    datagram[kNumber + 1] = static_cast<std::uint8_t>((i + 2) >> 8);
    attacker.send(datagram);
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(discovers());
  EXPECT_TRUE(speaks());
  EXPECT_EQ(victim->refused().why, "one source introduces too many participants");
}

// A participant's own announcements arrive at its discovery port again and again: they prove that
// the thread there works.
TEST_F(HostileDatagrams, TheOwnAnnouncementsComeThrough) {
  const auto is_within = [&](auto condition) {
    const auto end = std::chrono::steady_clock::now() + rtps::kPatience;
    while (!condition() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return condition();
  };
  EXPECT_TRUE(is_within([&] { return victim->own_came_through() != kNever; }));
  const Time first = victim->own_came_through();
  EXPECT_TRUE(is_within([&] { return victim->own_came_through() > first; }));
}

// Messages through the middleware come back only if sockets and threads work.
TEST(Hearing, IsDoubtfulWithoutTheThreadThatSpeaks) {
  const TestDomain domain;
  const auto participant = join(domain);
  Executor executor;
  const auto hearing = Hearing::begin(*participant, executor);
  ASSERT_TRUE(hearing);
  const auto is_within = [&](auto condition) {
    const auto end = std::chrono::steady_clock::now() + rtps::kPatience;
    while (!condition() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return condition();
  };
  const Time first = (*hearing)->heard();
  std::thread speaker([&] { executor.run(); });
  EXPECT_TRUE(is_within([&] { return (*hearing)->heard() != first; }));
  EXPECT_TRUE(is_within([&] { return (*hearing)->doubtful() > live_now(); }));
  executor.stop();
  speaker.join();
  EXPECT_TRUE(is_within([&] { return (*hearing)->doubtful() < live_now(); }));
}

}  // namespace
}  // namespace culprit::ros2
