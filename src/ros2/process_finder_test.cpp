#include "ros2/process_finder.h"

#include <arpa/inet.h>
#include <fstream>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

// A UDP socket on a port that the system chose.
class Socket {
 public:
  Socket() : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    bind(fd_, reinterpret_cast<const sockaddr*>(&address), size);
    getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Socket() { close(fd_); }
  std::uint16_t port() const { return port_; }

 private:
  int fd_;
  std::uint16_t port_ = 0;
};

ParticipantInfo participant_at(std::array<std::uint8_t, 4> ip, std::uint16_t port,
                               int said_pid = 0) {
  ParticipantInfo info;
  info.pid = said_pid;
  info.metatraffic = {{ip, port}};
  return info;
}

constexpr std::array<std::uint8_t, 4> kLoopback = {127, 0, 0, 1};

TEST(ProcessFinder, FindsTheOwnerOfThePort) {
  const Socket socket;
  EXPECT_EQ(ProcessFinder().find(participant_at(kLoopback, socket.port())), getpid());
}

TEST(ProcessFinder, ConfirmsATrueClaim) {
  const Socket socket;
  EXPECT_EQ(ProcessFinder().find(participant_at(kLoopback, socket.port(), getpid())), getpid());
}

TEST(ProcessFinder, CorrectsAFalseClaim) {
  const Socket socket;
  EXPECT_EQ(ProcessFinder().find(participant_at(kLoopback, socket.port(), 1)), getpid());
}

TEST(ProcessFinder, KnowsNothingOfOtherMachines) {
  const Socket socket;
  // 203.0.113.0/24 is for documentation only.
  EXPECT_EQ(ProcessFinder().find(participant_at({203, 0, 113, 1}, socket.port(), getpid())), 0);
}

TEST(ProcessFinder, KnowsNothingOfAClosedPort) {
  std::uint16_t port = 0;
  {
    const Socket socket;
    port = socket.port();
  }
  EXPECT_EQ(ProcessFinder().find(participant_at(kLoopback, port, getpid())), 0);
}

// A proc file system with one socket on port 0x1CF2 and one process that holds it.
class FakeProc {
 public:
  FakeProc() : path_(fs::temp_directory_path() / ("culprit-proc-" + std::to_string(getpid()))) {
    fs::create_directories(path_ / "net");
    fs::create_directories(path_ / "4242/fd");
    fs::create_symlink("socket:[777]", path_ / "4242/fd/5");
    std::ofstream(path_ / "net/udp") << "   sl  local_address rem_address   st tx_queue rx_queue "
                                        "tr tm->when retrnsmt   uid  timeout inode ref\n"
                                     << "  10: 0100007F:1CF2 00000000:0000 07 00000000:00000000 "
                                        "00:00000000 00000000  1000        0 777 2 0 0\n"
                                     << "a line that is none\n";
  }
  ~FakeProc() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(ProcessFinder, ReadsTheTablesOfTheKernel) {
  const FakeProc proc;
  const ProcessFinder finder(proc.path());
  EXPECT_EQ(finder.find(participant_at(kLoopback, 0x1cf2)), 4242);
  EXPECT_EQ(finder.find(participant_at(kLoopback, 0x1cf3)), 0);
}

TEST(ProcessFinder, SurvivesAMissingProcFileSystem) {
  EXPECT_EQ(ProcessFinder("/does/not/exist").find(participant_at(kLoopback, 1)), 0);
}

}  // namespace
}  // namespace culprit::ros2
