#include "process/supervisor.h"

#include <fstream>
#include <linux/capability.h>
#include <optional>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "process/spawn.h"

namespace culprit::process {
namespace {

using namespace std::chrono_literals;

// Supervises component c with the given launch command and tells what came of it.
class Supervised {
 public:
  explicit Supervised(const std::string& launch, const std::string& robot = "")
      : folder_(std::filesystem::temp_directory_path() /
                ("culprit-test-" + std::to_string(getpid()))),
        rules_(*check(Source("test.rules", "COMPONENT c LAUNCH \"" + launch + "\"\n")).rules) {
    supervisor.emplace(rules_, Supervisor::Options{folder_, {}, robot}, inbox);
  }
  ~Supervised() {
    if (supervisor) supervisor->stop_all();
    supervisor.reset();
    std::filesystem::remove_all(folder_);
  }

  int start() {
    supervisor->start({1}, ComponentId(0));
    const Reply reply = reply_to({1});
    EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
    const auto* pid = std::get_if<Value>(&reply.value);
    return pid == nullptr ? 0 : static_cast<int>(std::get<std::int64_t>(*pid));
  }
  void stop() {
    supervisor->stop({2}, ComponentId(0));
    EXPECT_EQ(reply_to({2}).outcome, Outcome::kDone);
  }
  Reply reply_to(CommandId command) {
    return wait<Reply>([&](const Reply& r) { return r.command == command; });
  }
  ProcessSeen state(ProcessState state) {
    return wait<ProcessSeen>([&](const ProcessSeen& s) { return s.state == state; });
  }
  std::string log_when(const std::string& part) {
    std::string text;
    for (int tries = 0; tries < 1000 && text.find(part) == std::string::npos; ++tries) {
      std::this_thread::sleep_for(10ms);
      std::ifstream file(folder_ / "c.log");
      text.assign(std::istreambuf_iterator<char>(file), {});
    }
    return text;
  }

  Inbox inbox;
  std::optional<Supervisor> supervisor;

 private:
  // The first observation of this kind that fits; waits up to half a minute, on any machine enough.
  template <class What, class Fits>
  What wait(Fits fits) {
    const Time end = live_now() + 30s;
    while (live_now() < end) {
      for (std::size_t i = 0; i < seen_.size(); ++i) {
        const auto* what = std::get_if<What>(&seen_[i].what);
        if (what == nullptr || !fits(*what)) continue;
        const What found = *what;
        seen_.erase(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return found;
      }
      inbox.take(end, seen_);
    }
    ADD_FAILURE() << "nothing of the kind was observed";
    return {};
  }

  std::filesystem::path folder_;
  RuleSet rules_;
  std::vector<Observation> seen_;
};

bool exists(int pid) { return kill(pid, 0) == 0; }

TEST(Supervisor, StartsAndStopsPolitely) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  EXPECT_TRUE(exists(pid));
  EXPECT_EQ(getpgid(pid), pid) << "it leads its own process group";
  c.supervisor->stop({2}, ComponentId(0));
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 2");
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
}

TEST(Supervisor, TellsHowAProcessEnded) {
  Supervised c("sh -c 'exit 3'");
  c.start();
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "exit code 3");
}

TEST(Supervisor, TellsThatAProcessWasKilled) {
  Supervised c("sleep 1000");
  kill(c.start(), SIGKILL);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9");
}

TEST(Supervisor, KillsWhatDoesNotListen) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  const Time begin = live_now();
  c.stop();
  EXPECT_FALSE(exists(pid));
  EXPECT_GE(live_now() - begin, Supervisor::kPolite + Supervisor::kFirm) << "it had its chances";
}

TEST(Supervisor, KillsAStoppedProcessAtOnce) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  kill(pid, SIGSTOP);
  EXPECT_EQ(c.state(ProcessState::kStopped).pid, pid);
  c.stop();
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, NoticesThatAStoppedProcessGoesOn) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  kill(pid, SIGSTOP);
  c.state(ProcessState::kStopped);
  kill(pid, SIGCONT);
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, pid);
}

TEST(Supervisor, EndsWhatTheProcessHadStarted) {
  Supervised c("sh -c 'sleep 1000 & echo child $!; wait'");
  c.start();
  const std::string log = c.log_when("child ");
  const int child = std::stoi(log.substr(log.find("child ") + 6));
  EXPECT_TRUE(exists(child));
  c.stop();
  for (int tries = 0; tries < 1000 && exists(child); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(exists(child));
}

TEST(Supervisor, CapturesOutput) {
  Supervised c("sh -c 'echo out; echo err >&2'");
  c.start();
  const std::string log = c.log_when("err");
  EXPECT_EQ(log, "out\nerr\n");
}

TEST(Supervisor, SaysWhenThereIsNoSuchProgram) {
  Supervised c("no-such-program-anywhere");
  c.supervisor->start({1}, ComponentId(0));
  const Reply reply = c.reply_to({1});
  EXPECT_EQ(reply.outcome, Outcome::kUnreachable);
  EXPECT_EQ(reply.text, "there is no program 'no-such-program-anywhere' in PATH");
}

TEST(Supervisor, StartsNoSecondProcessBesideALivingOne) {
  Supervised c("sleep 1000");
  c.start();
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
}

TEST(Supervisor, AdoptsAndEndsAProcessThatWasThere) {
  Supervised c("sleep 1000");
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null"});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt(ComponentId(0), *foreign, live_now());
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, *foreign);
  c.supervisor->stop({2}, ComponentId(0));
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign)) << "what is a child of this program is reaped, too";
}

TEST(Supervisor, LeavesItsProcessesRunningWhenItEnds) {
  int pid = 0;
  {
    const RuleSet rules = *check(Source("test.rules", "COMPONENT c LAUNCH \"sleep 1000\"\n")).rules;
    Inbox inbox;
    Supervisor supervisor(rules, {std::filesystem::temp_directory_path(), {}}, inbox);
    supervisor.start({1}, ComponentId(0));
    std::vector<Observation> seen;
    inbox.take(live_now() + 10s, seen);
    for (const Observation& o : seen) {
      if (const auto* process = std::get_if<ProcessSeen>(&o.what)) pid = process->pid;
    }
  }
  ASSERT_NE(pid, 0);
  EXPECT_TRUE(exists(pid));
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

// As after a crash: nothing is known but what the operating system says.
TEST(Supervisor, TakesOverWhatAnotherOneOfTheSameRobotStarted) {
  const std::string robot = "test/" + std::to_string(getpid());
  auto first = std::make_unique<Supervised>("sleep 1000", robot);
  const int pid = first->start();
  kill(pid, SIGSTOP);
  first->state(ProcessState::kStopped);
  first->supervisor.reset();

  Supervised stranger("sleep 1000", robot + "0");
  EXPECT_NE(stranger.start(), pid) << "another robot's component of the same name";
  Supervised second("sleep 1000", robot);
  EXPECT_EQ(second.state(ProcessState::kRunning).pid, pid);
  second.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(second.reply_to({3}).outcome, Outcome::kRefused);
  second.supervisor->stop({2}, ComponentId(0));
  EXPECT_EQ(second.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
  EXPECT_NE(second.start(), pid);
}

// As the tools of ROS 2 leave their daemon behind: in a session of its own, with all that it
// inherited.
TEST(Supervisor, IsNotMistakenAboutWhatAProcessLeftBehind) {
  const std::string robot = "test/daemon/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid sleep 1000 & echo daemon $!; wait'", robot);
  const int first = c.start();
  const std::string log = c.log_when("daemon ");
  const int daemon = std::stoi(log.substr(log.find("daemon ") + 7));
  c.stop();
  EXPECT_FALSE(exists(first));
  ASSERT_TRUE(exists(daemon)) << "it leads a group of its own";
  EXPECT_NE(c.start(), daemon) << "the component runs no more, so it can be started";
  kill(daemon, SIGKILL);
}

TEST(Supervisor, AdoptsAProcessAgainOnlyIfItIsTheSameOne) {
  Supervised c("sleep 1000");
  const Time before = live_now() - 1s;
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt_again(ComponentId(0), *foreign, before);
  const int started = c.start();
  EXPECT_NE(started, *foreign) << "a number that was given out anew since is not adopted";
  c.stop();
  c.supervisor->adopt_again(ComponentId(0), *foreign, live_now());
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
  c.supervisor->stop({4}, ComponentId(0));
  EXPECT_EQ(c.reply_to({4}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign));
}

TEST(Supervisor, AProcessThatBeganLaterIsAnother) {
  Supervised c("sleep 1000");
  const auto stranger = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(stranger);
  c.supervisor->adopt(ComponentId(0), *stranger, live_now() - 1s);
  EXPECT_EQ(c.state(ProcessState::kGone).pid, *stranger) << "what had its number is gone";
  c.stop();
  EXPECT_TRUE(exists(*stranger)) << "it is nobody's business";
  kill(*stranger, SIGKILL);
  waitpid(*stranger, nullptr, 0);
}

TEST(Spawn, PassesArgumentsAsTheyAre) {
  const auto log =
      std::filesystem::temp_directory_path() / ("culprit-spawn-" + std::to_string(getpid()));
  const auto pid = spawn({{"printf", "%s|", "a b", "$HOME", "; rm", "*"}, {}, log});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "a b|$HOME|; rm|*|");
  std::filesystem::remove(log);
}

TEST(Spawn, TellsTheProgramItsPid) {
  const auto log =
      std::filesystem::temp_directory_path() / ("culprit-pid-" + std::to_string(getpid()));
  const auto pid =
      spawn({{"sh", "-c", "sh -c 'echo $CULPRIT_PROCESS'"}, {}, log, {}, "CULPRIT_PROCESS"});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), std::to_string(*pid) + "\n");
  std::filesystem::remove(log);
}

TEST(Spawn, PassesNoCapabilityOn) {
  if (prctl(PR_CAPBSET_READ, CAP_KILL) != 1) GTEST_SKIP() << "there is none to pass on";
  __user_cap_header_struct who{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct has[2] = {};
  ASSERT_EQ(syscall(SYS_capget, &who, has), 0);
  has[0].inheritable |= 1U << CAP_KILL;
  if (syscall(SYS_capset, &who, has) != 0 ||
      prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE, CAP_KILL, 0, 0) != 0)
    GTEST_SKIP() << "this user cannot pass it on";
  const auto log =
      std::filesystem::temp_directory_path() / ("culprit-capability-" + std::to_string(getpid()));
  const auto pid = spawn({{"grep", "CapAmb", "/proc/self/status"}, {}, log});
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "CapAmb:\t0000000000000000\n");
  std::filesystem::remove(log);
}

TEST(Spawn, SaysWhyAProgramCannotBeStarted) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("culprit-spawn-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto bad = folder / "bad";
  std::ofstream(bad) << "#!/no/such/interpreter\n";
  std::filesystem::permissions(bad, std::filesystem::perms::owner_all);
  const auto pid = spawn({{bad}, {}, folder / "log"});
  ASSERT_FALSE(pid);
  EXPECT_EQ(pid.error(), "cannot start '" + bad.string() + "': No such file or directory");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace culprit::process
