// The whole program under attack: whatever strangers send, culprit stays small, can be ended, and
// goes on healing its robot. It also ends no process that a stranger points at.
#include <arpa/inet.h>
#include <atomic>
#include <csignal>
#include <fstream>
#include <mutex>
#include <netinet/in.h>
#include <set>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_connections.h"
#include "exemplars/sunset/node_process.h"
#include "robot/inbox.h"
#include "ros2/lifecycle.h"
#include "ros2/live_test.h"
#include "ros2/options.h"
#include "ros2/participant.h"
#include "ros2/publisher.h"
#include "ros2/service_server.h"
#include "ros2/services.h"
#include "ros2/test_forger.h"
#include "rtps/receive_thread.h"
#include "rtps/test_datagram.h"
#include "rtps/test_network.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kRules = R"(
ROBOT attacked
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraSilent
  POLICIES WARNING
  TRIGGER age(/managed_subsystem/rgb_camera) > 5s
    STRATEGY camera_restart 90 10
      ADAPTATION camera restart 5
)";
constexpr std::size_t kMostKilobytes = 64 * 1024;  // that an attack may make it grow by

template <class Done>
bool eventually(Done done, Duration patience = TestProgram::kPatience) {
  for (const Time end = live_now() + patience; !done();) {
    if (live_now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

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
      if (name == ros2::ReceiveThread::kName) threads.push_back(std::stoi(task.path().filename()));
    }
    return threads;
  }

 private:
  void wait_for_holder() {
    eventually([this] { return is_holding_.load(); });
  }
  void hold_all(int pid) {
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

struct Attack : testing::Test {
  ~Attack() override {
    for (const int pid : cameras()) kill(pid, SIGKILL);
  }
  TestProgram culprit(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"culprit",
                                          "run",
                                          world.write("attacked.rules", kRules),
                                          "--state-dir",
                                          (world.folder() / "state").string(),
                                          "--settle",
                                          "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return TestProgram(world, std::move(arguments));
  }
  std::vector<int> cameras() const {
    return sunset::processes_of(sunset::Member::kCamera, ros2::options_from_environment()->domain);
  }
  // Ends the camera, however it was started, and waits for another one.
  void is_healed(const TestProgram& culprit) {
    const std::size_t before = count_of(culprit.output(), "resolved by camera_redeploy");
    for (const int pid : cameras()) kill(pid, SIGKILL);
    EXPECT_TRUE(eventually([&] {
      return count_of(culprit.output(), "resolved by camera_redeploy") > before;
    })) << culprit.output();
    EXPECT_EQ(cameras().size(), 1u);
  }
  static int port_of(const TestProgram& culprit) {
    const std::string said = "http://127.0.0.1:";
    if (!culprit.prints(said)) return 0;
    return std::atoi(culprit.output().c_str() + culprit.output().find(said) + said.size());
  }

  TestWorld world;
};

TEST_F(Attack, OnThePageTakesNeitherDescriptorsNorMemoryFromTheManager) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const std::string program = own_folder() / "culprit";
  const TestProgram run(
      world,
      {"sh", "-c",
       "ulimit -n 64; exec " + program + " run " + world.write("attacked.rules", kRules) +
           " --settle 1 --state-dir " + (world.folder() / "state").string() + " --web --port 0"});
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  const int port = port_of(run);
  ASSERT_NE(port, 0) << run.output();
  const std::size_t before = holdings_of(run.pid()).kilobytes;
  Connections all(port);
  all.open(100);
  Connections endless(port);
  endless.open(10);
  endless.say("GET / HTTP/1.1\r\n");
  std::atomic<bool> is_over = false;
  std::thread writer([&] {
    const std::string header = "X-Long: " + std::string(60'000, 'x') + "\r\n";
    while (!is_over) {
      endless.say(header);
      std::this_thread::sleep_for(1ms);
    }
  });
  is_healed(run);
  is_over = true;
  writer.join();
  EXPECT_LT(holdings_of(run.pid()).kilobytes, before + kMostKilobytes);
}

TEST_F(Attack, WithHostileDatagramsLeavesItSmallAndHealing) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run = culprit();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  // Any participant of the domain knows the locators of all participants, and the writers.
  std::mutex mutex;
  std::set<int> ports;  // of each participant that it has: it looks at the robot with another one
  std::vector<ros2::Guid> writers;
  const auto spy = ros2::Participant::create(
      *ros2::options_from_environment(), [&](const ros2::DiscoveryEvent& event) {
        const std::lock_guard lock(mutex);
        if (const auto* info = std::get_if<ros2::ParticipantInfo>(&event)) {
          if (info->pid == run.pid() && !info->metatraffic.empty())
            ports.insert(info->metatraffic.front().port);
          for (const std::uint8_t entity : {3, 4}) {
            ros2::Guid guid = info->guid;
            guid.bytes[13] = 0, guid.bytes[14] = entity, guid.bytes[15] = 0xc2;
            writers.push_back(guid);
          }
        }
        const auto* endpoint = std::get_if<ros2::EndpointInfo>(&event);
        if (endpoint != nullptr && !endpoint->guid.is_reader()) writers.push_back(endpoint->guid);
      });
  ASSERT_TRUE(spy) << spy.error();
  ASSERT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex);
    return !ports.empty() && writers.size() > 10;
  }));
  is_healed(run);  // with all that it needs for that
  const std::size_t before = holdings_of(run.pid()).kilobytes;
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto attack = [&](const ros2::TestDatagram& datagram) {
    for (const int port : ports) {
      for (const int at : {port, port + 1}) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        to.sin_port = htons(static_cast<std::uint16_t>(at));
        sendto(socket, datagram.bytes().data(), datagram.bytes().size(), 0,
               reinterpret_cast<sockaddr*>(&to), sizeof to);
      }
    }
  };
  constexpr std::int64_t kAbsurd = std::int64_t{1} << 60;
  {
    const std::lock_guard lock(mutex);
    for (const ros2::Guid& each : writers) {
      const ros2::TestDatagram from(each.prefix());
      attack(ros2::TestDatagram(from).gap(each, 1, kAbsurd));
      attack(ros2::TestDatagram(from).heartbeat(each, kAbsurd, kAbsurd, 1 << 30));
      attack(ros2::TestDatagram(from).heartbeat(each, 1, kAbsurd, 1 << 29));
      attack(ros2::TestDatagram(from).data(each, kAbsurd));
    }
    for (int i = 0; i < 600; ++i) {
      const ros2::Guid& each = writers[static_cast<std::size_t>(i) % writers.size()];
      attack(ros2::TestDatagram(each.prefix()).fragment(each, 2 + i, 1, 1000, 20'000'000));
    }
  }
  close(socket);
  is_healed(run);
  is_healed(run);
  EXPECT_LT(holdings_of(run.pid()).kilobytes, before + kMostKilobytes);
  EXPECT_TRUE(run.prints("datagrams were kept out")) << run.output();
  // A flood that a busy machine cannot take in may make it deaf for a moment; then it says so.
  EXPECT_TRUE(eventually([&] {
    const std::string output = run.output();
    return count_of(output, "DEAF") == count_of(output, "can be heard again");
  })) << run.output();
}

TEST_F(Attack, ThatMakesItDeafDoesNotKeepItFromEnding) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram run = culprit();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  const Deafness deafness(run.pid());
  if (deafness.is_refused()) GTEST_SKIP() << "threads of another process cannot be held here";
  ASSERT_GT(deafness.held(), 0u);
  ASSERT_TRUE(run.prints("DEAF")) << run.output();
  run.signal(SIGINT);
  EXPECT_TRUE(run.wait().has_value()) << run.output();
  EXPECT_EQ(cameras().size(), 1u);
}

// One thread receives all: discovery, endpoint announcements to this process, and samples.
TEST_F(Attack, ThatHoldsTheThreadThatReceivesIsNoticedAndItsEndToo) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run = culprit();
  // The look before has a participant of its own, and is over then.
  ASSERT_TRUE(run.prints("/managed_subsystem/rgb_camera from")) << run.output();
  ASSERT_TRUE(eventually([&] { return Deafness::receivers_of(run.pid()).size() == 1; }));
  {
    const Deafness deafness(run.pid());
    if (deafness.is_refused()) GTEST_SKIP() << "threads of another process cannot be held here";
    EXPECT_EQ(deafness.held(), 1u);
    EXPECT_TRUE(run.prints("DEAF")) << run.output();
  }
  EXPECT_TRUE(run.prints("be heard again;")) << run.output();
}

TEST_F(Attack, ThatMakesItDeafStarvesItsWatchdogAndItBeginsAnewAndHeals) {
  Notifications systemd((world.folder() / "notify").string());
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run = culprit();
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
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
  is_healed(run);
}

// Events, claims and answers of a stranger on the same domain. They end no healthy node, and keep no dead one from being
// started again.
TEST_F(Attack, WithClaimsAboutANodeNeitherEndsItNorBlocksItsRepair) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  const TestProgram run(world,
                        {"culprit", "run", world.write("claimed.rules", R"(
ROBOT attacked
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE CameraOff
  POLICIES ERROR
  TRIGGER lifecycle(camera) == "inactive" || lifecycle(camera) == "finalized"
    STRATEGY camera_again 90 10
      ADAPTATION camera redeploy 5
)"),
                         "--settle", "1", "--state-dir", (world.folder() / "state").string()});
  ASSERT_TRUE(run.prints("camera is there")) << run.output();
  ASSERT_TRUE(eventually([&] { return cameras().size() == 1; }));
  const std::vector<int> before = cameras();

  const ros2::ParticipantOptions options = *ros2::options_from_environment();
  ros2::LiveContext stranger(options);
  ros2::NodeEntry liar(*stranger, {"/", "liar"});
  const auto events =
      ros2::RawPublisher::create(liar, "/managed_subsystem/camera/transition_event",
                                 ros2::msg::TransitionEvent::kType, ros2::qos::kDefault);
  ASSERT_TRUE(events);
  std::atomic<int> asked = 0;
  const auto lies = ros2::ServiceServer::create(
      liar, {"/managed_subsystem/camera/get_state", std::string(ros2::srv::GetState::kType)},
      ros2::qos::kServices, [&](ros2::ByteView) {
        ++asked;
        ros2::srv::GetState::Response response;
        response.current_state.id = static_cast<std::uint8_t>(LifecycleState::kFinalized);
        return ros2::encode(response);
      });
  ASSERT_TRUE(lies);
  for (int i = 0; i < 100; ++i) {
    ros2::msg::TransitionEvent event;
    event.goal_state.id = static_cast<std::uint8_t>(i % 2 == 0 ? LifecycleState::kInactive
                                                               : LifecycleState::kFinalized);
    (*events)->publish(ros2::encode(event));
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_GT(asked, 0) << "whoever offers a service is asked, too";
  EXPECT_EQ(cameras(), before) << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("CameraOff detected")));

  ros2::Forger claims(options, ros2::free_port());
  claims.says_that_it_holds({"/managed_subsystem", "camera", {}, {}});
  EXPECT_TRUE(run.prints("claims the name /managed_subsystem/camera")) << run.output();
  is_healed(run);
}

// A stranger on another computer holds the node's name, and announces a port of a process here.
TEST_F(Attack, FromAnotherComputerDoesNotChooseWhoIsEnded) {
  auto network = TestNetwork::create();
  if (!network) GTEST_SKIP() << network.error();
  setenv("ROS_LOCALHOST_ONLY", "0", 1);
  std::optional<TestNetwork::Visit> here(std::in_place, **network, TestNetwork::kRobot);
  const ros2::Bound port = ros2::bound();
  TestProgram victim(world, {"sleep", "600"});  // inherits it
  close(port.descriptor);
  const TestProgram run(world, {"culprit", "run", world.write("attacked.rules", R"(
ROBOT attacked
COMPONENT camera NODE /camera LAUNCH "sleep 600"
RULE CameraThere
  POLICIES ERROR
  TRIGGER alive(camera)
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
)"),
                                "--settle", "1", "--quiet", "0", "--no-evidence", "--state-dir",
                                (world.folder() / "state").string()});
  ASSERT_TRUE(run.prints("watching attacked")) << run.output();
  here.reset();
  here.emplace(**network, TestNetwork::kDesk);
  ros2::Forger stranger(*ros2::options_from_environment(), port.port, "10.77.0.2");
  stranger.says_that_it_holds({"/", "camera", {}, {}});
  EXPECT_TRUE(run.prints("its process is not known; is it on another machine?")) << run.output();
  std::this_thread::sleep_for(3s);
  EXPECT_FALSE(victim.wait(0s)) << "it was ended: " << run.output();
  EXPECT_THAT(run.output(), Not(HasSubstr("redeploy camera: done")));
}

}  // namespace
}  // namespace culprit::cli
