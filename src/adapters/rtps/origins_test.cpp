#include "rtps/origins.h"

#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "rtps/test_datagram.h"
#include "rtps/test_sockets.h"

namespace culprit::rtps {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Time kStart{std::chrono::hours(1)};
constexpr Ip kOwn = {192, 0, 2, 7};  // 192.0.2.0/24 and 203.0.113.0/24 are for documentation only
constexpr Ip kElsewhere = {203, 0, 113, 1};
constexpr Ip kAny = {};
constexpr int kPid = 4242;
constexpr int kStranger = 99;

GuidPrefix camera() { return {{1, 2, 3}}; }
GuidPrefix lidar() { return {{7, 8, 9}}; }

// The sockets and processes of a machine, as proc(5) has them.
class FakeMachine {
 public:
  FakeMachine() {
    fs::create_directories(folder_ / "net");
    run(kPid, 1000);
    run(kStranger, 2000);
    write();
  }
  void run(int pid, int began) {
    fs::create_directories(process(pid) / "fd");
    std::ofstream(process(pid) / "stat")
        << pid << " (node) S 1 1 1 0 -1 0 0 0 0 0 0 0 0 0 20 0 1 0 " << began << " 0\n";
  }
  void end(int pid) {
    fs::remove_all(process(pid));
    for (auto& [inode, each] : sockets_) std::erase(each.holders, pid);
    write();
  }
  // Gives its number.
  int open(int pid, Ip ip, std::uint16_t port, unsigned user = 0) {
    sockets_[++inode_] = {{ip, port}, user, {}};
    hold(pid, inode_);
    return inode_;
  }
  void hold(int pid, int inode) {
    sockets_[inode].holders.push_back(pid);
    fs::create_symlink("socket:[" + std::to_string(inode) + "]",
                       process(pid) / "fd" / std::to_string(inode));
    write();
  }
  void close(int pid, int inode) {
    fs::remove(process(pid) / "fd" / std::to_string(inode));
    std::erase(sockets_[inode].holders, pid);
    write();
  }
  // Its threads end one after the other: the first has closed the files, the last holds the sockets.
  void begin_to_end(int pid) {
    fs::remove_all(process(pid) / "fd");
    fs::create_directory(process(pid) / "fd");
  }
  void hide_tables() { fs::remove_all(folder_ / "net"); }
  void hide_files(int pid) { fs::remove_all(process(pid) / "fd"); }
  const fs::path& path() const { return folder_.path(); }

 private:
  struct Open {
    UdpAddress address;
    unsigned user = 0;
    std::vector<int> holders;
  };
  fs::path process(int pid) const { return folder_ / std::to_string(pid); }
  void write() const {
    std::ofstream table(folder_ / "net/udp");
    table << "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid\n";
    for (const auto& [inode, each] : sockets_) {
      if (each.holders.empty()) continue;
      std::uint32_t ip = 0;
      std::memcpy(&ip, each.address.ip.data(), sizeof ip);
      char line[200];
      std::snprintf(line, sizeof line,
                    " 1: %08X:%04X 00000000:0000 07 00000000:00000000 00:00000000 00000000 %u 0 "
                    "%d 2 0000 0\n",
                    ip, each.address.port, each.user, inode);
      table << line;
    }
  }

  test::TestFolder folder_;
  std::map<int, Open> sockets_;
  int inode_ = 100;
};

// The camera is process kPid, and speaks from port 40000 of any address.
struct OriginsOfAMachine : testing::Test {
  OriginsOfAMachine() {
    socket = machine.open(kPid, kAny, 40'000);
    machine.open(kStranger, kAny, 7410);
  }
  void prove() {
    const std::array spoke_from = {UdpAddress{kOwn, 40'000}};
    origins.prove(camera(), kPid, spoke_from);
  }
  bool counts(const UdpAddress& from, Time now = later(kStart, 1s),
              const GuidPrefix& name = camera()) {
    return origins.counts(TestDatagram(name).bytes(), from, now);
  }

  FakeMachine machine;
  int socket = 0;
  Time clock = kStart;
  Duration a_look_takes{};  // half of it at its begin
  Origins origins{machine.path(),
                  [] {
                    return std::set<Ip>{kLoopback, kOwn};
                  },
                  [this] { return clock += a_look_takes; }};
};

TEST_F(OriginsOfAMachine, AreTheSocketsOfTheProcess) {
  prove();
  EXPECT_TRUE(counts({kOwn, 40'000}));
  EXPECT_TRUE(counts({kLoopback, 40'000}));
  EXPECT_FALSE(counts({kOwn, 40'001})) << "of another port";
  EXPECT_FALSE(counts({kElsewhere, 40'000})) << "of another machine, from the same port";
  EXPECT_EQ(origins.dropped(), 2u);
}

TEST_F(OriginsOfAMachine, BeforeAProofEverythingCounts) {
  EXPECT_TRUE(counts({kElsewhere, 1}));
  prove();
  EXPECT_TRUE(counts({kElsewhere, 1}, kStart, lidar())) << "whose process is not proven";
  origins.forget(camera());
  EXPECT_TRUE(counts({kElsewhere, 1}));
  EXPECT_EQ(origins.dropped(), 0u);
}

TEST_F(OriginsOfAMachine, AnotherNameWithinADatagramIsNoExcuse) {
  prove();
  Bytes source = {0, 0, 0, 0, 2, 3, 1, 15};
  const GuidPrefix name = camera();
  source.insert(source.end(), name.bytes.begin(), name.bytes.end());
  const TestDatagram datagram = TestDatagram(lidar()).submessage(0x0c, 0, source);
  EXPECT_FALSE(origins.counts(datagram.bytes(), {kElsewhere, 40'000}, kStart));
}

TEST_F(OriginsOfAMachine, AnotherProcessOfTheMachineDoesNotCount) {
  machine.open(kStranger, kAny, 50'000, 1001);
  prove();
  EXPECT_FALSE(counts({kLoopback, 50'000}));
  EXPECT_THAT(origins.new_sources(),
              ElementsAre(ForeignSource{{kLoopback, 50'000}, 1001, camera(), kPid}));
}

TEST_F(OriginsOfAMachine, ASocketThatItOpensLaterCountsAtOnce) {
  prove();
  for (int i = 0; i < 10; ++i) {
    const Time now = later(kStart, (i + 1) * 1s);
    const auto port = static_cast<std::uint16_t>(41'000 + i);
    machine.open(kPid, kAny, port);
    EXPECT_TRUE(counts({kOwn, port}, now));
  }
}

TEST_F(OriginsOfAMachine, ASocketThatItOpensRightAfterTheProofCountsAtOnce) {
  prove();
  machine.open(kPid, kAny, 41'000);
  EXPECT_TRUE(counts({kOwn, 41'000}, later(kStart, 1ms)));
}

TEST_F(OriginsOfAMachine, AFloodInItsNameDoesNotSilenceIt) {
  prove();
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(counts({kLoopback, 50'000}, later(kStart, i * 1ms)));
    EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, i * 1ms)));
  }
  EXPECT_EQ(origins.new_sources().size(), 1u) << "each source is reported once";
  EXPECT_THAT(origins.new_sources(), IsEmpty());
}

TEST_F(OriginsOfAMachine, APortThatItGaveUpIsNotItsAnyMore) {
  const int second = machine.open(kPid, kAny, 40'002);
  prove();
  EXPECT_TRUE(counts({kOwn, 40'002}));
  machine.close(kPid, second);
  machine.open(kStranger, kAny, 40'002);
  origins.check(later(kStart, 1s));
  EXPECT_FALSE(counts({kOwn, 40'002}, later(kStart, 1s)));
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 1s)));
}

// Every participant has the port for multicast, and so may a stranger.
// A survey of culprit's own has just ended.
TEST_F(OriginsOfAMachine, WhatThisProcessSentBeforeItClosedASocketAccusesNobody) {
  const int own = getpid();
  machine.run(own, 3000);
  machine.open(own, kAny, 40'100);
  const int closed = machine.open(own, kAny, 40'101);
  const std::array spoke_from = {UdpAddress{kOwn, 40'101}};
  origins.prove(lidar(), own, spoke_from);
  machine.close(own, closed);
  origins.check(later(kStart, 1s));
  EXPECT_FALSE(counts({kOwn, 40'101}, later(kStart, 1s), lidar()));
  EXPECT_THAT(origins.new_sources(), IsEmpty());
  machine.open(kStranger, kAny, 40'102, 1000);
  EXPECT_FALSE(counts({kOwn, 40'102}, later(kStart, 3s), lidar()));
  EXPECT_THAT(origins.new_sources(),
              ElementsAre(ForeignSource{{kOwn, 40'102}, 1000u, lidar(), own}));
}

TEST_F(OriginsOfAMachine, APortThatItSharesSaysNothing) {
  machine.open(kPid, kAny, 7400);
  machine.open(kStranger, kAny, 7400);
  prove();
  EXPECT_FALSE(counts({kOwn, 7400}));
  EXPECT_TRUE(counts({kOwn, 40'000}));
}

TEST_F(OriginsOfAMachine, ASourceWithoutAPortOfItsOwnMaySendFromASharedOne) {
  machine.open(kPid, kAny, 7400);
  machine.open(kStranger, kAny, 7400);
  const std::array spoke_from = {UdpAddress{kOwn, 7400}};
  origins.prove(camera(), kPid, spoke_from);
  EXPECT_TRUE(counts({kOwn, 7400}));
}

TEST_F(OriginsOfAMachine, WhereTheTablesCannotBeReadEverythingOfThisMachineCounts) {
  prove();
  machine.hide_tables();
  EXPECT_TRUE(counts({kOwn, 50'000}, later(kStart, 1s)));
  EXPECT_FALSE(counts({kElsewhere, 50'000}, later(kStart, 1s)));
  origins.check(later(kStart, 2s));
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 2s)));
}

TEST_F(OriginsOfAMachine, WhereItsFilesCannotBeSeenAnyMoreEverythingOfThisMachineCounts) {
  prove();
  machine.hide_files(kPid);
  EXPECT_TRUE(counts({kOwn, 50'000}, later(kStart, 1s)));
}

TEST_F(OriginsOfAMachine, ASlowTableTakesNoMoreThanItsShareOfTheTime) {
  prove();
  a_look_takes = 100ms;
  const Time before = clock;
  int counted = 0;
  constexpr int kSeconds = 10;
  for (int i = 0; i < kSeconds * 1000; ++i)
    counted += counts({kLoopback, static_cast<std::uint16_t>(1000 + i)}, later(kStart, i * 1ms));
  const auto looks = (clock - before) / (2 * a_look_takes);
  EXPECT_LE((looks - 1) * a_look_takes, Duration(1s) * kSeconds / Origins::kShareOfTime);
  EXPECT_GT(counted, 0) << "what is not looked up counts";
}

TEST_F(OriginsOfAMachine, NobodySpeaksForAProcessThatHasEnded) {
  prove();
  machine.end(kPid);
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 1s))) << "its good-bye, which was under way";
  origins.check(later(kStart, 2s));
  EXPECT_FALSE(counts({kOwn, 40'000}, later(kStart, 3s)));
  EXPECT_FALSE(counts({kOwn, 50'000}, later(kStart, 3s)));
  origins.check(later(kStart, 2s + Origins::kAfterEnd));
  EXPECT_TRUE(counts({kOwn, 50'000}, later(kStart, 2s + Origins::kAfterEnd)));
}

// A stranger speaks in its name at the instant of its death, before it is found dead.
TEST_F(OriginsOfAMachine, NobodySpeaksForAProcessThatIsJustEnding) {
  prove();
  machine.begin_to_end(kPid);
  EXPECT_FALSE(counts({kOwn, 50'000}, later(kStart, 1s)));
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 1s))) << "its good-bye, which was under way";
  machine.end(kPid);
  EXPECT_FALSE(counts({kOwn, 50'000}, later(kStart, 2s)));
}

TEST_F(OriginsOfAMachine, ANodeThatOthersSpokeForIsDiscoveredAgainOnce) {
  const std::array spoke_from = {UdpAddress{kOwn, 40'000}, UdpAddress{kElsewhere, 5}};
  EXPECT_FALSE(origins.prove(camera(), kPid, spoke_from));
  EXPECT_EQ(origins.take_doubtful(), camera());
  EXPECT_EQ(origins.take_doubtful(), std::nullopt);
  origins.forget(camera());
  EXPECT_FALSE(counts({kElsewhere, 5})) << "where it speaks from stays known";
  origins.forget(camera());
  EXPECT_TRUE(counts({kElsewhere, 5}));
}

TEST_F(OriginsOfAMachine, ANumberOfAProcessThatIsGivenAgainIsAnotherProcess) {
  prove();
  machine.end(kPid);
  machine.run(kPid, 5000);
  machine.open(kPid, kAny, 45'000);
  EXPECT_FALSE(counts({kOwn, 45'000}, later(kStart, 1s)));
  origins.prove(camera(), kPid, {});
  EXPECT_TRUE(counts({kOwn, 45'000}, later(kStart, 2s))) << "which was proven, too";
}

TEST_F(OriginsOfAMachine, AForkThatLivesOnMaySpeak) {
  machine.hold(kStranger, socket);
  prove();
  machine.end(kPid);
  origins.check(later(kStart, 1s));
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 1s)));
  EXPECT_FALSE(counts({kOwn, 50'000}, later(kStart, 1s)));
  origins.check(later(kStart, 1s + Origins::kEnds));
  EXPECT_TRUE(counts({kOwn, 50'000}, later(kStart, 1s + Origins::kEnds)))
      << "its process is unknown";
}

TEST_F(OriginsOfAMachine, OfASystemThatTellsNoInterfacesTheKnownOnesStay) {
  Origins failing(machine.path(), [] { return std::set<Ip>{kLoopback}; });
  const std::array spoke_from = {UdpAddress{kOwn, 40'000}};
  failing.prove(camera(), kPid, spoke_from);
  EXPECT_TRUE(failing.counts(TestDatagram(camera()).bytes(), {kOwn, 40'000}, kStart));
}

// The lidar is on another computer, and has answered from there.
struct OriginsElsewhere : OriginsOfAMachine {
  OriginsElsewhere() {
    origins.begin_to_bind(self);
    origins.discovered(lidar(), std::array{UdpAddress{kThere, 7410}}, kStart);
  }
  bool speaks(const Ip& from, Duration after) {
    return counts({from, 7411}, later(kStart, after), lidar());
  }
  bool answers(const Ip& from, Duration after) {
    Bytes to(self.bytes.begin(), self.bytes.end());
    const TestDatagram datagram =
        TestDatagram(lidar()).submessage(0x0e, 0, to).submessage(0x06, 0, Bytes(24));
    return origins.counts(datagram.bytes(), {from, 7411}, later(kStart, after));
  }
  // From 6 s on.
  void is_bound() {
    EXPECT_TRUE(speaks(kThere, 1s));
    EXPECT_TRUE(answers(kThere, 6s));
  }

  static constexpr Ip kThere = {203, 0, 113, 5};
  static constexpr Ip kElsewhere = {203, 0, 113, 66};
  const GuidPrefix self{{5, 5, 5}};
};

TEST_F(OriginsElsewhere, AreThoseFromWhichItAnswered) {
  is_bound();
  EXPECT_TRUE(speaks(kThere, 7s));
  EXPECT_FALSE(speaks(kElsewhere, 7s));
  EXPECT_FALSE(speaks(kOwn, 7s)) << "a program of this machine";
  EXPECT_EQ(origins.new_sources().size(), 2u);
}

TEST_F(OriginsElsewhere, AreNotKnownBeforeItAnswered) {
  EXPECT_TRUE(speaks(kThere, 6s));
  EXPECT_TRUE(speaks(kElsewhere, 7s));
}

TEST_F(OriginsElsewhere, AreNotKnownWhereSeveralSpokeInItsNameFromTheBeginning) {
  EXPECT_TRUE(speaks(kElsewhere, 1s));
  is_bound();
  EXPECT_TRUE(answers(kElsewhere, 7s));
  EXPECT_TRUE(speaks(kThere, 8s)) << "the first one does not silence the other";
}

TEST_F(OriginsElsewhere, AreAllThatItAnnounced) {
  const Ip wireless = {203, 0, 113, 6};
  is_bound();
  origins.discovered(lidar(), std::array{UdpAddress{wireless, 7410}}, later(kStart, 7s));
  EXPECT_TRUE(speaks(wireless, 8s));
  EXPECT_TRUE(speaks(kThere, 8s));
}

TEST_F(OriginsElsewhere, ChangeWhenItIsSilentAtTheOldOnes) {
  is_bound();
  for (int i = 1; i < 20; ++i) {
    EXPECT_TRUE(speaks(kThere, 6s + i * 1s));
    EXPECT_FALSE(speaks(kElsewhere, 6s + i * 1s + 500ms)) << i;
  }
  EXPECT_FALSE(speaks(kElsewhere, 26s));
  EXPECT_TRUE(speaks(kElsewhere, 36s)) << "it moved";
  EXPECT_TRUE(speaks(kThere, 37s)) << "and is not bound until it answers from there alone";
}

TEST_F(OriginsElsewhere, MatterNoMoreOnceItsProcessIsProven) {
  is_bound();
  origins.prove(lidar(), kPid, {});
  EXPECT_TRUE(counts({kOwn, 40'000}, later(kStart, 7s), lidar()));
  EXPECT_FALSE(speaks(kThere, 7s));
}

// As of a thread in another network namespace.
TEST(Origins, ATableWithoutOurOwnSocketsSaysNothing) {
  FakeMachine machine;
  const int own = getpid();
  machine.run(own, 1);
  const int socket = machine.open(own, kAny, 7411);
  machine.open(kPid, kAny, 40'000);
  Origins origins(machine.path(), [] { return std::set<Ip>{kLoopback, kOwn}; });
  origins.prove(lidar(), own, {});
  origins.prove(camera(), kPid, {});
  const Bytes datagram = TestDatagram(camera()).bytes();
  EXPECT_FALSE(origins.counts(datagram, {kOwn, 50'000}, kStart));
  machine.close(own, socket);
  EXPECT_TRUE(origins.counts(datagram, {kOwn, 50'001}, later(kStart, 1s)));
}

TEST(Origins, AreThoseOfTheKernel) {
  std::optional<TestSocket> its(std::in_place);
  const TestFork process(its->descriptor());
  const UdpAddress address = its->address();
  its.reset();
  const TestSocket stranger;
  Origins origins;
  origins.prove(camera(), process.pid(), std::array{address});
  const Bytes datagram = TestDatagram(camera()).bytes();
  const Time now = live_now();
  EXPECT_TRUE(origins.counts(datagram, address, now));
  EXPECT_FALSE(origins.counts(datagram, stranger.address(), later(now, 1s)));
  EXPECT_FALSE(origins.counts(datagram, {kElsewhere, address.port}, now));
  origins.check(later(now, 2s));
  EXPECT_TRUE(origins.counts(datagram, address, later(now, 2s)));
}

}  // namespace
}  // namespace culprit::rtps
