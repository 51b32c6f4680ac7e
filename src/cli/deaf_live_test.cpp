// culprit while it receives no datagrams: it says that it is deaf, can be ended, and begins anew under a watchdog.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "cli/test_attacked_robot.h"
#include "rtps/receive_thread.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

// Receives culprit's notifications in place of systemd.
class Notifications {
 public:
  explicit Notifications(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "1000000", 1);
  }
  ~Notifications() {
    close(socket_);
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }
  Notifications(const Notifications&) = delete;

  // How often the watchdog was fed since it was asked last.
  int feedings() {
    int count = 0;
    char text[256];
    for (ssize_t size; (size = recv(socket_, text, sizeof text, MSG_DONTWAIT)) > 0;)
      count +=
          std::string(text, static_cast<std::size_t>(size)).find("WATCHDOG=1") != std::string::npos;
    return count;
  }

 private:
  const int socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

// Holds the threads of a process on which datagrams arrive: it is deaf then, and its middleware
// hangs. A thread of our own holds them, for the tracer must stay the same thread.
class Deafness {
 public:
  explicit Deafness(int pid) : holder_([this, pid] { hold_all(pid); }) { wait_for_holder(); }
  ~Deafness() {
    is_over_ = true;
    holder_.join();
  }
  Deafness(const Deafness&) = delete;
  std::size_t held() const { return held_; }
  // By the system, as that of a container may.
  bool is_refused() const { return is_refused_; }

  // The threads on which datagrams arrive: one for each participant.
  static std::vector<int> receivers_of(int pid) {
    std::vector<int> threads;
    const std::string tasks = "/proc/" + std::to_string(pid) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      std::string name;
      std::ifstream(task.path() / "comm") >> name;
      if (name == rtps::ReceiveThread::kName) threads.push_back(std::stoi(task.path().filename()));
    }
    return threads;
  }

 private:
  void wait_for_holder() {
    AttackedRobot::eventually([this] { return is_holding_.load(); });
  }
  void hold_all(int pid) {
    // The participant that compared the names with the robot has one, too, until it is gone.
    AttackedRobot::eventually([pid] { return receivers_of(pid).size() == 1; });
    std::vector<int> threads;
    for (const int thread : receivers_of(pid)) hold(thread, threads);
    keep(threads);
  }
  void hold(int thread, std::vector<int>& held) {
    is_refused_ = ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0;
    if (is_refused_) return;
    ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr);
    waitpid(thread, nullptr, __WALL);
    held.push_back(thread);
  }
  void keep(const std::vector<int>& threads) {
    held_ = threads.size();
    is_holding_ = true;
    // A traced thread that exits must be waited for, or its process cannot execute another program.
    while (!is_over_) {
      for (const int thread : threads) waitpid(thread, nullptr, __WALL | WNOHANG);
      std::this_thread::sleep_for(10ms);
    }
    for (const int thread : threads) ptrace(PTRACE_DETACH, thread, nullptr, nullptr);
  }

  std::atomic<std::size_t> held_ = 0;
  std::atomic<bool> is_refused_ = false;
  std::atomic<bool> is_holding_ = false;
  std::atomic<bool> is_over_ = false;
  std::thread holder_;
};

using Deaf = AttackedRobot;

TEST_F(Deaf, CulpritCanBeEnded) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram run = start_culprit();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  ASSERT_TRUE(has_looked(run)) << run.output();
  const Deafness deafness(run.pid());
  if (deafness.is_refused()) GTEST_SKIP() << "threads of another process cannot be held here";
  ASSERT_GT(deafness.held(), 0u);
  ASSERT_TRUE(run.prints("DEAF")) << run.output();
  run.signal(SIGINT);
  EXPECT_TRUE(run.wait().has_value()) << run.output();
  EXPECT_EQ(cameras().size(), 1u);
}

// One thread receives all: discovery, endpoint announcements to this process, and samples.
TEST_F(Deaf, CulpritReportsTheBeginningAndTheEnd) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run = start_culprit();
  ASSERT_TRUE(has_looked(run)) << run.output();
  {
    const Deafness deafness(run.pid());
    if (deafness.is_refused()) GTEST_SKIP() << "threads of another process cannot be held here";
    EXPECT_EQ(deafness.held(), 1u);
    EXPECT_TRUE(run.prints("DEAF")) << run.output();
  }
  EXPECT_TRUE(run.prints("messages again;")) << run.output();
}

TEST_F(Deaf, CulpritStarvesItsWatchdogBeginsAnewAndHeals) {
  Notifications systemd((world.folder() / "notify").string());
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run = start_culprit();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  ASSERT_TRUE(has_looked(run)) << run.output();
  EXPECT_TRUE(eventually([&] { return systemd.feedings() > 0; }));
  const Deafness deafness(run.pid());
  if (deafness.is_refused()) GTEST_SKIP() << "threads of another process cannot be held here";
  ASSERT_GT(deafness.held(), 0u);
  ASSERT_TRUE(run.prints("DEAF")) << run.output();
  systemd.feedings();
  std::this_thread::sleep_for(3s);
  EXPECT_EQ(systemd.feedings(), 0) << "of the second that it has";
  EXPECT_EQ(cameras().size(), 1u) << "nothing is judged";
  ASSERT_TRUE(run.prints("culprit restarts", 60s)) << run.output();
  ASSERT_TRUE(eventually([&] { return count_of(run.output(), "watching attacked") == 2; }, 60s))
      << run.output();
  EXPECT_TRUE(eventually([&] { return systemd.feedings() > 0; }));
  ASSERT_TRUE(eventually([&] { return count_of(run.output(), "camera is there") > 1; }))
      << run.output();
  expect_healed(run);
}

}  // namespace
}  // namespace culprit::cli
