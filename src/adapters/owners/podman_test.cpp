// A real podman is asked, over its REST API, where there is one and it may run containers: as root, with
// podman and crun. Elsewhere these tests are skipped, with what is missing.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/test_asked_owner.h"
#include "owners/test_process.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// An engine of its own with one container, `slam`, which sleeps. It shares the programs of this machine:
// no image is needed. In a mount namespace of its own, with version 2 of the control groups: crun takes no
// machine that has both.
class Podman {
 public:
  Podman() {
    std::filesystem::create_directories(own_.path() / "files/tmp");
    std::ofstream(own_.path() / "serve") << R"(
      umount -R /sys/fs/cgroup
      mount -t cgroup2 none /sys/fs/cgroup || exit 1
      cd "$OWN"
      podman="podman --root $OWN/root --runroot $OWN/run --storage-driver vfs \
        --cgroup-manager cgroupfs --events-backend file"
      $podman create --name slam --rootfs --network host --privileged --pids-limit 0 \
        --ulimit nofile=1024:1024 --ulimit nproc=1000:1000 -v /usr:/usr:ro -v /lib:/lib:ro \
        -v /lib64:/lib64:ro -v /bin:/bin:ro -v /etc:/etc:ro "$OWN/files" /bin/sleep 1000 || exit 1
      exec $podman system service --time 0 unix://$OWN/socket)";
    const auto service = spawn({.arguments = {"unshare", "-m", "sh", own_.path() / "serve"},
                                .search_first = {},
                                .log = own_.path() / "log",
                                .environment = {"OWN=" + own_.path().string()}});
    if (service) service_ = *service;
    while (is_alive(service_) && !std::filesystem::exists(own_.path() / "socket"))
      std::this_thread::sleep_for(10ms);
    setenv("CONTAINER_HOST", ("unix://" + (own_.path() / "socket").string()).c_str(), 1);
  }
  ~Podman() {
    if (serves()) {
      const auto ended = spawn({.arguments = {"podman", "--remote", "rm", "-f", "-t", "0", "slam"},
                                .search_first = {},
                                .log = own_.path() / "log"});
      if (ended) waitpid(*ended, nullptr, 0);
    }
    unsetenv("CONTAINER_HOST");
    if (service_ == 0) return;
    kill(-service_, SIGKILL);
    waitpid(service_, nullptr, 0);
  }
  Podman(const Podman&) = delete;
  Podman& operator=(const Podman&) = delete;

  bool serves() const { return std::filesystem::exists(own_.path() / "socket"); }
  std::string said() const {
    std::ifstream log(own_.path() / "log");
    return {std::istreambuf_iterator<char>(log), {}};
  }

 private:
  test::TestFolder own_;
  int service_ = 0;
};

struct ContainersOfPodman : AsksAnOwner {
  void SetUp() override {
    if (std::system("command -v podman crun unshare > /dev/null") != 0 || geteuid() != 0)
      GTEST_SKIP() << "needs root, podman and crun";
    engine.emplace();
    if (!engine->serves()) GTEST_SKIP() << "podman cannot run here: " << engine->said();
    manage("slam", "CONTAINER podman slam", Units::Of::kEngines);
  }
  void TearDown() override { units.reset(); }  // before the engine that it asks
  int started() {
    const Reply reply = start();
    EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
    const auto* pid = std::get_if<Value>(&reply.value);
    return pid == nullptr ? 0 : static_cast<int>(std::get<std::int64_t>(*pid));
  }
  std::optional<Podman> engine;
};

TEST_F(ContainersOfPodman, AreStartedReplacedAndStopped) {
  const int first = started();
  ASSERT_TRUE(is_alive(first));
  EXPECT_FALSE(container_of(first).empty());
  const Reply replaced = stop(first);
  EXPECT_EQ(replaced.outcome, Outcome::kDone) << replaced.text;
  EXPECT_FALSE(is_alive(first));
  const int second = started();
  EXPECT_NE(second, first);
  ASSERT_TRUE(is_alive(second));
  EXPECT_NE(stop(getpid()).outcome, Outcome::kDone) << "it is not of the container";
  EXPECT_TRUE(is_alive(second));
  const Reply stopped = stop(second, Ending::kForGood);
  EXPECT_EQ(stopped.outcome, Outcome::kDone) << stopped.text;
  EXPECT_FALSE(is_alive(second));
}

TEST_F(ContainersOfPodman, ThatWereKilledAreDeadAndStartAgain) {
  const int first = started();
  units->found(ComponentId(0), first);
  end(first);
  EXPECT_TRUE(wait_for<ProcessSeen>(
      [](const ProcessSeen& each) { return each.state == ProcessState::kGone; }));
  const Reply ended = stop(first);
  EXPECT_EQ(ended.outcome, Outcome::kDone) << ended.text;
  EXPECT_TRUE(is_alive(started()));
}

}  // namespace
}  // namespace culprit::owners
