// Attackers of the same computer, most of them another user, and a computer that lacks what culprit needs.
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "cli/test_attacks.h"
#include "cli/test_connections.h"
#include "cli/test_hostile_sockets.h"
#include "cli/test_repeatedly.h"
#include "owners/mark.h"

namespace culprit::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

// Processes that are killed with it.
class Strangers {
 public:
  Strangers() = default;
  ~Strangers() {
    for (const pid_t each : pids_) {
      kill(each, SIGKILL);
      waitpid(each, nullptr, 0);
    }
  }
  Strangers(const Strangers&) = delete;
  Strangers& operator=(const Strangers&) = delete;

  void add(pid_t pid) { pids_.push_back(pid); }

 private:
  std::vector<pid_t> pids_;
};

// Root's pause and its end beside 100 sockets of another user.
class HostileSockets {
 public:
  explicit HostileSockets(const Target& target) {
    for (const char* name : {"65534", "guest"}) {
      folders_.push_back("/tmp/culprit-" + std::string(name) +
                         (std::string(name) == "guest" ? "-" + std::to_string(getpid()) : ""));
      strangers_.add(start_hostile(folders_.back(), environment("ROS_DOMAIN_ID"), 50));
    }
    for (const char* order : {"pause", "resume"}) {
      const Time begin = live_now();
      TestProgram program(target.world, {"culprit", order});
      EXPECT_EQ(program.wait(), 0) << program.output();
      EXPECT_THAT(program.output(), HasSubstr("process " + std::to_string(target.culprit)));
      EXPECT_LT(live_now() - begin, Duration(10s)) << "one silent socket alone would cost 5 s";
    }
  }
  ~HostileSockets() {
    std::error_code error;
    for (const fs::path& each : folders_) fs::remove_all(each, error);
  }
  HostileSockets(const HostileSockets&) = delete;
  HostileSockets& operator=(const HostileSockets&) = delete;

 private:
  std::vector<fs::path> folders_;
  Strangers strangers_;  // end first
};
Ongoing hostile_sockets(const Target& target) {
  return geteuid() == 0 ? std::make_shared<HostileSockets>(target) : nullptr;
}

// Another user's process that carries the three variables of the camera.
Ongoing marks_of_the_camera(const Target&) {
  auto strangers = std::make_shared<Strangers>();
  const pid_t pid = fork();
  if (pid == 0) {
    if (geteuid() == 0 && (setresgid(kStranger, kStranger, kStranger) != 0 ||
                           setresuid(kStranger, kStranger, kStranger) != 0))
      _exit(2);
    const std::string domain = environment("ROS_DOMAIN_ID");
    for (const std::string& each : owners::mark_of(domain + "/attacked/camera")) {
      const auto at = each.find('=');
      setenv(each.substr(0, at).c_str(), each.c_str() + at + 1, 1);
    }
    setenv(owners::kPidVariable, std::to_string(getpid()).c_str(), 1);
    execlp("sleep", "sleep", "600", nullptr);
    _exit(3);
  }
  strangers->add(pid);
  return geteuid() == 0 ? strangers : nullptr;  // of the same user it is believed
}

// As somebody who reads the logs, and never lets go.
class LogLocks {
 public:
  explicit LogLocks(fs::path folder)
      : folder_(std::move(folder)), lock_(50ms, [this] { lock_all(); }) {}
  ~LogLocks() {
    for (const int each : held_) close(each);
  }
  LogLocks(const LogLocks&) = delete;
  LogLocks& operator=(const LogLocks&) = delete;

 private:
  void lock_all() {
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder_, error), end; at != end; at.increment(error)) {
      if (error || at->path().extension() != ".log") continue;
      const int file = open(at->path().c_str(), O_RDONLY | O_CLOEXEC);
      const bool is_held = file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0;
      if (is_held) held_.push_back(file);
      if (!is_held && file >= 0) close(file);
    }
  }

  const fs::path folder_;
  std::vector<int> held_;
  Repeatedly lock_;  // ends first
};
Ongoing locks_on_logs(const Target& target) {
  return std::make_shared<LogLocks>(target.world.folder());
}

Ongoing a_pipe_as_rules(const Target& target) {
  const fs::path pipe = target.world.folder() / "pipe.rules";
  const fs::path link = target.world.folder() / "link.rules";
  if (!fs::exists(pipe)) {
    EXPECT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    fs::create_symlink(pipe, link);
  }
  for (const fs::path& each : {pipe, link, fs::path("/dev/zero")}) {
    TestProgram check(target.world, {"culprit", "check", each.string()});
    EXPECT_TRUE(check.wait().value_or(0) > 0) << each << ": " << check.output();
  }
  return std::make_shared<int>(0);
}

// Processes that do nothing but compute.
Ongoing a_busy_machine(const Target&) {
  auto strangers = std::make_shared<Strangers>();
  for (unsigned i = 0; i < 4 * std::thread::hardware_concurrency(); ++i) {
    const pid_t pid = fork();
    for (volatile std::uint64_t n = 0; pid == 0;) n = n + 1;
    strangers->add(pid);
  }
  return strangers;
}

// As the freezer of a container's engine.
Ongoing culprit_is_frozen(const Target& target) {
  kill(target.culprit, SIGSTOP);
  std::this_thread::sleep_for(7s);  // more than the silence that a rule allows
  kill(target.culprit, SIGCONT);
  return std::make_shared<int>(0);
}
// ---- what it lacks

class Limit {
 public:
  Limit(int pid, __rlimit_resource what, rlim_t most) : pid_(pid), what_(what) {
    rlimit before{};
    EXPECT_EQ(prlimit(pid, what, nullptr, &before), 0);
    before_ = before;
    const rlimit now{most, before.rlim_max};
    EXPECT_EQ(prlimit(pid, what, &now, nullptr), 0);
  }
  ~Limit() { prlimit(pid_, what_, &before_, nullptr); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  const int pid_;
  const __rlimit_resource what_;
  rlimit before_{};
};

std::size_t address_space_of(int pid) {
  std::size_t pages = 0;
  std::ifstream("/proc/" + std::to_string(pid) + "/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

struct Scarcity {
  Scarcity(const Target& target, __rlimit_resource what, rlim_t most)
      : limit(target.culprit, what, most), readers(target.page) {
    readers.open(100);
    readers.say("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
  }
  Limit limit;
  Connections readers;
};
Ongoing little_memory(const Target& target) {
  constexpr std::size_t kMore = std::size_t{64} << 20;
  return std::make_shared<Scarcity>(target, RLIMIT_AS, address_space_of(target.culprit) + kMore);
}
// It has a few more than it holds, for a start needs some.
Ongoing few_descriptors(const Target& target) {
  return std::make_shared<Scarcity>(target, RLIMIT_NOFILE,
                                    holdings_of(target.culprit).descriptors + 24);
}

// A control group that allows few more threads than there are.
class FewThreads {
 public:
  explicit FewThreads(const Target& target) : readers_(target.page) {
    const bool is_old = fs::exists("/sys/fs/cgroup/pids/cgroup.procs");
    const fs::path root = is_old ? "/sys/fs/cgroup/pids" : "/sys/fs/cgroup";
    before_ = root / group_of(target.culprit, is_old ? ":pids:/" : "0::/");
    group_ = root / ("culprit-hostile-" + std::to_string(target.culprit));
    std::error_code error;
    if (!fs::exists(root / "cgroup.procs") || !fs::create_directory(group_, error)) return;
    is_set_ = fs::exists(group_ / "pids.max") && write(group_ / "cgroup.procs", target.culprit);
    const std::string tasks = "/proc/" + std::to_string(target.culprit) + "/task";
    const auto threads = std::distance(fs::directory_iterator(tasks), {});
    // A start takes two processes, and the new node has its threads.
    write(group_ / "pids.max", threads + 40);
    readers_.open(100);
    readers_.say("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n");
  }
  ~FewThreads() {
    std::ifstream members(group_ / "cgroup.procs");
    for (int pid = 0; members >> pid;) write(before_ / "cgroup.procs", pid);
    std::error_code error;
    fs::remove(group_, error);
  }
  FewThreads(const FewThreads&) = delete;
  FewThreads& operator=(const FewThreads&) = delete;
  bool is_set() const { return is_set_; }

 private:
  static bool write(const fs::path& file, std::int64_t number) {
    std::ofstream out(file);
    out << number << std::flush;
    return out.good();
  }
  static std::string group_of(int pid, const std::string& kind) {
    std::ifstream groups("/proc/" + std::to_string(pid) + "/cgroup");
    for (std::string line; std::getline(groups, line);) {
      const auto at = line.find(kind);
      if (at != std::string::npos) return line.substr(at + kind.size());
    }
    return "";
  }

  fs::path before_;
  fs::path group_;
  bool is_set_ = false;
  Connections readers_;
};
Ongoing few_threads(const Target& target) {
  auto few = std::make_shared<FewThreads>(target);
  return few->is_set() ? few : nullptr;
}

}  // namespace

std::vector<Attack> attacks_on_this_computer() {
  return {
      {"hostile_sockets", hostile_sockets},
      {"marks_of_the_camera", marks_of_the_camera, Place::kHere, true},
      {"locks_on_logs", locks_on_logs},
      {"a_pipe_as_rules", a_pipe_as_rules},
      {"a_busy_machine", a_busy_machine},
      {"culprit_is_frozen", culprit_is_frozen},
      {"little_memory", little_memory},
      {"few_descriptors", few_descriptors, Place::kHere, true},
      {"few_threads", few_threads},
  };
}

}  // namespace culprit::cli
