#include "ros2/process_finder.h"

#include <arpa/inet.h>
#include <csignal>
#include <fstream>
#include <memory>
#include <netinet/in.h>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "rtps/test_sockets.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr rtps::Ip kOtherLoopback = {127, 0, 0, 2};
constexpr rtps::Ip kElsewhere = {203, 0, 113, 1};  // 203.0.113.0/24 is for documentation only

// Announces one address and sends from another.
ParticipantInfo participant(const rtps::UdpAddress& announced, const rtps::UdpAddress& sends_from,
                            int said_pid = 0) {
  ParticipantInfo info;
  info.pid = said_pid;
  info.metatraffic = {announced};
  info.origin = {{sends_from}, true};
  return info;
}

struct Sockets {
  rtps::TestSocket listens, sends;
  ParticipantInfo participant(int said_pid = 0) const {
    return ros2::participant(listens.address(), sends.address(), said_pid);
  }
};

TEST(ProcessFinder, FindsTheProcessThatHoldsBothSockets) {
  const Sockets sockets;
  const FoundProcess found = ProcessFinder().find(sockets.participant());
  EXPECT_EQ(found.pid, getpid()) << found.missing;
  EXPECT_EQ(found.missing, "");
}

TEST(ProcessFinder, ConfirmsATrueClaim) {
  const Sockets sockets;
  EXPECT_EQ(ProcessFinder().find(sockets.participant(getpid())).pid, getpid());
}

TEST(ProcessFinder, CorrectsAFalseClaim) {
  const Sockets sockets;
  EXPECT_EQ(ProcessFinder().find(sockets.participant(1)).pid, getpid());
}

TEST(ProcessFinder, OfForksThatHoldTheSameItFindsTheOldest) {
  const rtps::TestSocket socket;
  const rtps::TestFork fork(socket.descriptor());
  const ParticipantInfo both = participant(socket.address(), socket.address());
  EXPECT_EQ(ProcessFinder().find(both).pid, getpid());
}

TEST(ProcessFinder, KnowsNothingOfOtherMachines) {
  const Sockets sockets;
  ParticipantInfo info = sockets.participant(getpid());
  info.metatraffic.front().ip = kElsewhere;
  const FoundProcess found = ProcessFinder().find(info);
  EXPECT_EQ(found.pid, 0);
  EXPECT_EQ(found.missing, "") << "it does not claim to be here";
}

// Its bridge for containers has the address that ours has.
TEST(ProcessFinder, AProcessElsewhereMayHaveAnAddressOfOurs) {
  const Sockets sockets;
  ParticipantInfo info = sockets.participant(getpid());
  info.metatraffic.push_back({kElsewhere, 7410});
  info.origin.addresses = {{kElsewhere, 4321}};
  const FoundProcess found = ProcessFinder().find(info);
  EXPECT_EQ(found.pid, 0);
  EXPECT_EQ(found.missing, "");
}

// Somebody on the network announces a port of this machine as his own.
TEST(ProcessFinder, AnAnnouncedPortAloneProvesNothing) {
  const Sockets sockets;
  const rtps::UdpAddress attacker{kElsewhere, 4321};
  const FoundProcess found =
      ProcessFinder().find(participant(sockets.listens.address(), attacker, getpid()));
  EXPECT_EQ(found.pid, 0);
  EXPECT_EQ(found.missing,
            "it claims to be on this machine, but datagrams in its name come from "
            "203.0.113.1:4321");
}

// A sender on the network speaks in the name of a participant of this machine.
TEST(ProcessFinder, OneForeignDatagramSpeaksAgainstIt) {
  const Sockets sockets;
  ParticipantInfo info = sockets.participant(getpid());
  info.origin.addresses.push_back({kElsewhere, 4321});
  EXPECT_EQ(ProcessFinder().find(info).pid, 0);
}

TEST(ProcessFinder, APortOfSomebodyElseProvesNothing) {
  auto others = std::make_unique<rtps::TestSocket>();
  const rtps::TestFork victim(others->descriptor());
  const rtps::UdpAddress announced = others->address();
  others.reset();  // the fork alone has it
  const Sockets sockets;
  const FoundProcess found =
      ProcessFinder().find(participant(announced, sockets.sends.address(), victim.pid()));
  EXPECT_EQ(found.pid, 0);
  EXPECT_THAT(found.missing, HasSubstr("no process with readable files holds all"));
}

TEST(ProcessFinder, APortOfAnotherAddressIsAnother) {
  const rtps::TestSocket listens(kOtherLoopback), sends;
  const rtps::UdpAddress announced{rtps::kLoopback, listens.address().port};
  EXPECT_EQ(ProcessFinder().find(participant(listens.address(), sends.address())).pid, getpid());
  EXPECT_EQ(ProcessFinder().find(participant(announced, sends.address())).pid, 0);
}

TEST(ProcessFinder, WithoutADatagramNothingIsProven) {
  const Sockets sockets;
  ParticipantInfo info = sockets.participant(getpid());
  info.origin = {};
  EXPECT_THAT(ProcessFinder().find(info).missing, HasSubstr("nothing is known"));
  info.origin = {{sockets.sends.address()}, false};
  EXPECT_THAT(ProcessFinder().find(info).missing, HasSubstr("more places"));
}

TEST(ProcessFinder, KnowsNothingOfAClosedPort) {
  rtps::UdpAddress closed;
  closed = rtps::TestSocket().address();
  const rtps::TestSocket sends;
  EXPECT_THAT(ProcessFinder().find(participant(closed, sends.address(), getpid())).missing,
              HasSubstr("no process of this machine has the socket"));
}

// Participants whose process is not proven: another user's, or one that sent no datagram.
TEST(ProcessFinder, AProcessWithoutItsSocketsHasEnded) {
  auto gone = std::make_unique<Sockets>();
  const Sockets lives;
  ParticipantInfo unproven = gone->participant();
  unproven.origin = {};
  ParticipantInfo replaced = participant(lives.listens.address(), gone->sends.address());
  EXPECT_FALSE(ProcessFinder().find(unproven).has_ended);
  EXPECT_FALSE(ProcessFinder().find(replaced).has_ended);
  gone.reset();
  EXPECT_TRUE(ProcessFinder().find(unproven).has_ended);
  EXPECT_TRUE(ProcessFinder().find(replaced).has_ended) << "another has its port";
}

TEST(ProcessFinder, AProcessThatMayBeElsewhereIsNotKnownToHaveEnded) {
  rtps::UdpAddress closed;
  closed = rtps::TestSocket().address();
  const rtps::TestSocket sends;
  ParticipantInfo info = participant(closed, sends.address());
  info.metatraffic.push_back({kElsewhere, 7410});
  EXPECT_FALSE(ProcessFinder().find(info).has_ended);
  info = participant(closed, {kElsewhere, 4321});
  EXPECT_FALSE(ProcessFinder().find(info).has_ended);
  EXPECT_FALSE(
      ProcessFinder("/does/not/exist").find(participant(closed, sends.address())).has_ended);
}

// A proc file system with a socket on port 0x1CF2 and one on 0x1CF4, both made by user 1000, and
// one process that holds them.
class FakeProc {
 public:
  explicit FakeProc(const std::string& user) {
    fs::create_directories(path_ / "net");
    fs::create_directories(path_ / "4242/fd");
    fs::create_symlink("socket:[777]", path_ / "4242/fd/5");
    fs::create_symlink("socket:[778]", path_ / "4242/fd/6");
    std::ofstream(path_ / "4242/status") << "Name:\tnode\nUid:\t" << user << "\t" << user << "\n";
    std::ofstream(path_ / "net/udp") << "   sl  local_address rem_address   st tx_queue rx_queue "
                                        "tr tm->when retrnsmt   uid  timeout inode ref\n"
                                     << "  10: 0100007F:1CF2 00000000:0000 07 00000000:00000000 "
                                        "00:00000000 00000000  1000        0 777 2 0 0\n"
                                     << "  11: 00000000:1CF4 00000000:0000 07 00000000:00000000 "
                                        "00:00000000 00000000  1000        0 778 2 0 0\n"
                                     << "a line that is none\n";
  }
  const fs::path& path() const { return path_; }

 private:
  test::TestFolder own_;
  fs::path path_ = own_.path();
};

TEST(ProcessFinder, ReadsTheTablesOfTheKernel) {
  const FakeProc proc("1000");
  const ProcessFinder finder(proc.path());
  EXPECT_EQ(finder.find(participant({rtps::kLoopback, 0x1cf2}, {rtps::kLoopback, 0x1cf4})).pid,
            4242);
  EXPECT_EQ(finder.find(participant({rtps::kLoopback, 0x1cf3}, {rtps::kLoopback, 0x1cf4})).pid, 0);
}

// A socket can be handed to the process of another user, which then holds it.
TEST(ProcessFinder, ASocketThatAnotherUserMadeProvesNothing) {
  const FakeProc proc("0");
  EXPECT_EQ(ProcessFinder(proc.path())
                .find(participant({rtps::kLoopback, 0x1cf2}, {rtps::kLoopback, 0x1cf4}, 4242))
                .pid,
            0);
}

TEST(ProcessFinder, KnowsTheSpeakerThoughOthersSpeakInThatNameToo) {
  std::optional<rtps::TestSocket> its(std::in_place);
  const rtps::UdpAddress address = its->address();
  const rtps::TestFork process(its->descriptor());
  its.reset();
  const rtps::TestSocket stranger;
  ParticipantInfo info = participant(address, address);
  info.origin.addresses.push_back(stranger.address());
  EXPECT_EQ(ProcessFinder().find(info).pid, 0);
  EXPECT_EQ(ProcessFinder().speaker(info), process.pid());
  info.origin.addresses = {stranger.address()};
  EXPECT_EQ(ProcessFinder().speaker(info), 0) << "it never spoke in that name";
}

// As the port for multicast is, which every participant has.
TEST(ProcessFinder, APortThatOthersShareProvesNothing) {
  std::optional<rtps::TestSocket> its(std::in_place);
  std::optional<rtps::TestSocket> shared(std::in_place, rtps::kLoopback,
                                         rtps::TestSocket::Port::kShared);
  const rtps::TestFork process(its->descriptor(), shared->descriptor());
  const rtps::UdpAddress announced = its->address();
  const rtps::UdpAddress multicast = shared->address();
  its.reset();
  shared.reset();
  EXPECT_EQ(ProcessFinder().find(participant(announced, multicast)).pid, process.pid());
  const rtps::TestSocket stranger(rtps::kLoopback, rtps::TestSocket::Port::kShared, multicast.port);
  EXPECT_EQ(ProcessFinder().find(participant(announced, multicast)).pid, 0);
  EXPECT_EQ(ProcessFinder().speaker(participant(announced, multicast)), 0);
}

TEST(ProcessFinder, SurvivesAMissingProcFileSystem) {
  EXPECT_EQ(ProcessFinder("/does/not/exist")
                .find(participant({rtps::kLoopback, 1}, {rtps::kLoopback, 2}))
                .pid,
            0);
}

TEST(ProcessFinder, AZombieDoesNotRun) {
  const int pid = fork();
  if (pid == 0) _exit(0);
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT), 0);
  EXPECT_EQ(kill(pid, 0), 0) << "its number is there";
  EXPECT_FALSE(ProcessFinder().is_running(pid));
  waitpid(pid, nullptr, 0);
  EXPECT_TRUE(ProcessFinder().is_running(getpid()));
}

}  // namespace
}  // namespace culprit::ros2
