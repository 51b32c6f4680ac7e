#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "owners/file_descriptor.h"
#include "owners/supervisor.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// A component whose process holds the lock file of a port, as a node of Fast DDS.
struct WithPort {
  bool is_free() const {
    const FileDescriptor lock(open(file.c_str(), O_RDONLY | O_CLOEXEC));
    return !lock || flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
  }
  bool becomes(bool free) const {
    for (const Time end = live_now() + 5s; is_free() != free && live_now() < end;)
      std::this_thread::sleep_for(1ms);
    return is_free() == free;
  }
  ~WithPort() { std::filesystem::remove(file); }

  const std::string file = "/dev/shm/fastrtps_port" + std::to_string(getpid()) + "999_el";
  const std::string launch = "sh -c 'exec 9>>" + file + "; flock -n 9; exec sleep 1000'";
};

// The successor of a stopped process must not get the ports on which its writers have given up.
TEST(Supervisor, KeepsTheSharedMemoryPortsOfWhatItKills) {
  const WithPort port;
  {
    Supervised supervised(port.launch);
    const int pid = supervised.start();
    EXPECT_TRUE(port.becomes(false)) << "the process has it";
    kill(pid, SIGSTOP);
    supervised.state(ProcessState::kStopped);
    supervised.stop();
    EXPECT_FALSE(port.is_free()) << "culprit has it";
    EXPECT_NE(supervised.start(), 0);
    EXPECT_FALSE(port.is_free());
  }
  EXPECT_TRUE(port.is_free());
}

TEST(Supervisor, KeepsTheSharedMemoryPortsOfNodesThatOthersKill) {
  const WithPort port;
  Supervised supervised(port.launch);
  const int pid = supervised.start();
  EXPECT_TRUE(port.becomes(false));
  supervised.supervisor->adopt(ComponentId(0), pid, live_now());
  kill(pid, SIGKILL);
  supervised.state(ProcessState::kGone);
  EXPECT_FALSE(port.is_free());
}

// As if the culprit that kept them had been killed.
TEST(Supervisor, KeepsTheSharedMemoryPortsThatWereLeftBeforeItBegan) {
  const WithPort port;
  std::ofstream(port.file).flush();
  EXPECT_TRUE(port.is_free());
  {
    const Supervised supervised("sleep 1000");
    EXPECT_FALSE(port.is_free());
  }
  EXPECT_TRUE(port.is_free());
}

// As Fast DDS does at an end in order.
TEST(Supervisor, LeavesSharedMemoryPortsThatWereRemoved) {
  const WithPort port;
  Supervised supervised(port.launch);
  const int pid = supervised.start();
  EXPECT_TRUE(port.becomes(false));
  supervised.supervisor->adopt(ComponentId(0), pid, live_now());
  std::filesystem::remove(port.file);
  kill(pid, SIGKILL);
  supervised.state(ProcessState::kGone);
  EXPECT_TRUE(port.is_free());
}

}  // namespace
}  // namespace culprit::owners
