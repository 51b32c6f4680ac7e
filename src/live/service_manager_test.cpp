#include "live/service_manager.h"

#include <cstdlib>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::live {
namespace {

using namespace std::chrono_literals;

// systemd's end of the socket.
class ServiceManagerTest : public testing::Test {
 protected:
  ServiceManagerTest()
      : path_(testing::TempDir() + "culprit-notify-" + std::to_string(getpid())),
        socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~ServiceManagerTest() override {
    close(socket_);
    unlink(path_.c_str());
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }

  // Empty if nothing was said.
  std::string heard() const {
    char text[256];
    const auto length = recv(socket_, text, sizeof text, 0);
    return length < 0 ? "" : std::string(text, static_cast<std::size_t>(length));
  }

 private:
  std::string path_;
  int socket_;
};

TEST_F(ServiceManagerTest, HearsWhenTheServiceIsReadyAndWhenItStops) {
  const ServiceManager systemd;
  systemd.ready("watching 3 components");
  EXPECT_EQ(heard(), "READY=1\nSTATUS=watching 3 components");
  systemd.stopping();
  EXPECT_EQ(heard(), "STOPPING=1");
}

TEST_F(ServiceManagerTest, IsFedTwiceInTheTimeOfItsWatchdog) {
  setenv("WATCHDOG_USEC", "10000000", 1);
  ServiceManager systemd;
  systemd.feed(Time{100s});
  EXPECT_EQ(heard(), "WATCHDOG=1");
  EXPECT_EQ(systemd.next_feeding(), Time{105s});
  systemd.feed(Time{104s});
  EXPECT_EQ(heard(), "");
  systemd.feed(Time{105s});
  EXPECT_EQ(heard(), "WATCHDOG=1");
}

TEST_F(ServiceManagerTest, IsNotFedWithoutAWatchdogOrForAnotherProcess) {
  for (const char* pid : {"", "1"}) {
    if (*pid != '\0') setenv("WATCHDOG_USEC", "10000000", 1);
    setenv("WATCHDOG_PID", pid, 1);
    ServiceManager systemd;
    systemd.feed(Time{100s});
    EXPECT_EQ(systemd.next_feeding(), kNever);
    EXPECT_EQ(heard(), "");
  }
}

TEST(ServiceManager, IsNotNeeded) {
  unsetenv("NOTIFY_SOCKET");
  ServiceManager nobody;
  nobody.ready("");
  nobody.feed(Time{100s});
  EXPECT_EQ(nobody.next_feeding(), kNever);
}

}  // namespace
}  // namespace culprit::live
