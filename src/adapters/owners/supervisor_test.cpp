#include "owners/supervisor.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <linux/capability.h>
#include <optional>
#include <poll.h>
#include <pty.h>
#include <set>
#include <signal.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "language/checker.h"
#include "owners/bounded_log.h"
#include "owners/launch_note.h"
#include "owners/mark.h"
#include "owners/proc.h"
#include "owners/spawn.h"
#include "owners/started_processes.h"
#include "owners/test_control_group.h"
#include "owners/test_process.h"
#include "owners/watched_process.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

// Supervises component c with the given launch command and reports the results.
class Supervised {
 public:
  explicit Supervised(const std::string& launch, const std::string& robot = "")
      : Supervised(Declared{"LAUNCH \"" + launch + "\""}, robot) {}
  struct Declared {
    std::string clauses;
  };
  explicit Supervised(const Declared& component, const std::string& robot = "")
      : folder_(std::filesystem::temp_directory_path() /
                ("culprit-test-" + std::to_string(getpid()))),
        rules_(*check(Source("test.rules", "COMPONENT c " + component.clauses + "\n")).rules),
        robot_(robot) {
    supervise();
  }
  // Anew, as after a restart of culprit.
  void supervise(const std::filesystem::path& logs = {}) {
    supervisor.reset();
    Supervisor::Options options{logs.empty() ? folder_ : logs, {}, robot_};
    if (environment) options.environments = {*environment};
    supervisor.emplace(rules_, std::move(options), inbox);
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
    supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
    EXPECT_EQ(reply_to({2}).outcome, Outcome::kDone);
  }
  std::string trouble() {
    return wait<LinkTrouble>([](const LinkTrouble&) { return true; }).text;
  }
  Reply stop_to_start_again() {
    supervisor->stop({7}, ComponentId(0), 0, Ending::kToStartAgain);
    return reply_to({7});
  }
  const std::filesystem::path& folder() const { return folder_; }
  Reply reply_to(CommandId command) {
    return wait<Reply>([&](const Reply& r) { return r.command == command; });
  }
  ProcessSeen state(ProcessState state) {
    return wait<ProcessSeen>([&](const ProcessSeen& s) { return s.state == state; });
  }
  LauncherSeen launcher() {
    return wait<LauncherSeen>([](const LauncherSeen&) { return true; });
  }
  StartedHere started() {
    return wait<StartedHere>([](const StartedHere&) { return true; });
  }
  std::string missing() {
    return wait<StartBarred>([](const StartBarred& s) { return !s.missing.empty(); }).missing;
  }
  void nothing_missing() {
    wait<StartBarred>([](const StartBarred& s) { return s.missing.empty(); });
  }
  int worked() {
    return wait<ProcessWorked>([](const ProcessWorked&) { return true; }).pid;
  }
  bool hears_of_no_work_for(Duration time) {
    std::vector<Observation> seen;
    inbox.take(live_now(), seen);
    seen.clear();
    for (const Time end = later(live_now(), time); live_now() < end;) inbox.take(end, seen);
    return std::none_of(seen.begin(), seen.end(), [](const Observation& o) {
      return std::holds_alternative<ProcessWorked>(o.what);
    });
  }
  std::filesystem::path log() const {
    std::string name = robot_.empty() ? "c" : robot_ + "/c";
    std::ranges::replace(name, '/', '-');
    return folder_ / (name + ".log");
  }
  std::string log_when(const std::string& part) {
    std::string text;
    for (int tries = 0; tries < 1000 && text.find(part) == std::string::npos; ++tries) {
      std::this_thread::sleep_for(10ms);
      std::ifstream file(log());
      text.assign(std::istreambuf_iterator<char>(file), {});
    }
    return text;
  }

  Inbox inbox;
  std::optional<Supervisor> supervisor;
  std::optional<Expected<std::vector<std::string>>> environment;  // of supervise()

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
  std::string robot_;
  std::vector<Observation> seen_;
};

bool exists(int pid) { return kill(pid, 0) == 0; }

bool becomes(int pid, const std::string& program) {
  for (int tries = 0; tries < 3000; ++tries) {
    const auto identity = identity_of(pid);
    if (identity && identity->program.ends_with(program)) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

// Somebody else's launcher, which starts a process again whenever it ends.
class Respawning {
 public:
  explicit Respawning(const std::string& command = "sleep 1000")
      : pid_(*spawn({{"sh", "-c", "while :; do " + command + "; done"}, {}, "/dev/null"})) {}
  ~Respawning() {
    const int left = child();
    end();
    if (left != 0) kill(left, SIGKILL);
  }
  // The process that runs now, another than `before`.
  int child(int before = 0) const {
    for (int tries = 0; tries < 1000; ++tries) {
      for (const Relative& each : descendants_of(pid_)) {
        if (each.pid != before && each.command == "sleep") return each.pid;
      }
      if (is_ended_) return 0;
      std::this_thread::sleep_for(10ms);
    }
    return 0;
  }
  void end() {
    if (std::exchange(is_ended_, true)) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

 private:
  int pid_;
  bool is_ended_ = false;
};

// ---- starts that cannot happen now

// A program that runs for a while, and can be taken away and brought back as a build does it.
struct Barred : testing::Test {
  void build() {
    const std::filesystem::path made = folder / "made";
    std::ofstream(made) << "#!/bin/sh\nexec sleep 1000\n";
    std::filesystem::permissions(made, std::filesystem::perms::owner_all);
    std::filesystem::rename(made, folder / "driver");
  }
  std::string program() const { return (folder / "driver").native(); }
  test::TestFolder folder;
};

TEST_F(Barred, AStartWithoutItsProgramSaysWhichOneIsMissingAndWhenItIsBack) {
  Supervised c(program());
  c.supervisor->start({1}, ComponentId(0));
  EXPECT_EQ(c.missing(), "there is no program '" + program() + "', or it is not executable");
  EXPECT_EQ(c.reply_to({1}).outcome, Outcome::kUnreachable);
  build();
  c.nothing_missing();
  EXPECT_NE(c.start(), 0);
}

TEST_F(Barred, AStartWithoutItsParametersSaysWhichFileIsMissing) {
  build();
  const std::string file = (folder / "launch_params_x").native();
  Supervised c(program() + " --ros-args --params-file " + file);
  c.supervisor->start({1}, ComponentId(0));
  EXPECT_EQ(c.missing(), "there is no parameter file '" + file + "'");
  std::ofstream(file) << "/**:\n";
  c.nothing_missing();
  EXPECT_NE(c.start(), 0);
}

TEST_F(Barred, NothingIsEndedThatCouldNotBeStartedAgain) {
  build();
  Supervised c(program());
  const int pid = c.start();
  // Until the shell has read its script, and sleeps.
  while (std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe").filename() !=
         "sleep")
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::filesystem::remove(program());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain);
  EXPECT_EQ(c.missing(), "there is no program '" + program() + "', or it is not executable");
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
  EXPECT_EQ(kill(pid, 0), 0) << "it goes on";
  build();
  c.nothing_missing();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
}

TEST_F(Barred, WhatIsBeingWrittenIsWaitedFor) {
  Supervised c(program());
  c.supervisor->start({1}, ComponentId(0));
  c.missing();
  const Time since = live_now();
  build();
  c.nothing_missing();
  EXPECT_GE(live_now() - since, 500ms) << "a build may still be at it";
}

TEST(Supervisor, LeavesWhatIsRespawnedToItsLauncher) {
  const Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int first = launcher.child();
  c.supervisor->adopt(ComponentId(0), first, live_now());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused) << "it would come back";
  EXPECT_TRUE(exists(first));
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0) << "a second one was started";
  EXPECT_NE(launcher.child(first), 0);
}

TEST(Supervisor, TakesOverFromALauncherThatHasEnded) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"}, "7/test");
  const int orphan = launcher.child();
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  launcher.end();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  const int ours = c.start();
  EXPECT_NE(ours, 0);
  c.supervise();  // another culprit knows it by its mark
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_NE(c.start(), 0) << "there is no launcher any more to wait for";
}

TEST(Supervisor, TakesOverFromALauncherThatEndedBeforeItCame) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int orphan = launcher.child();
  launcher.end();
  while (parent_of(orphan) == getpid()) std::this_thread::sleep_for(1ms);
  if (parent_of(orphan) != 1) {
    kill(orphan, SIGKILL);
    GTEST_SKIP() << "orphans of this machine do not go to init";
  }
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_NE(c.start(), 0) << "there is no launcher any more to wait for";
}

// Its launcher is unknown, and so is whether that launcher will start it again.
TEST(Supervisor, WaitsForTheProgramThatInitStartedItFor) {
  int pid = 0;
  int pipe_of[2];
  ASSERT_EQ(pipe2(pipe_of, O_CLOEXEC), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    if (fork() == 0) {
      const int self = setsid();  // as what init starts is
      (void)!write(pipe_of[1], &self, sizeof self);
      execl("/bin/sleep", "sleep", "1000", nullptr);
    }
    _exit(0);
  }
  ASSERT_EQ(read(pipe_of[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  waitpid(parent, nullptr, 0);
  close(pipe_of[0]);
  close(pipe_of[1]);
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0);
}

// It ends with its program, and its launcher starts it again.
TEST(Supervisor, TakesRos2RunForNoLauncher) {
  const test::TestFolder folder;
  const std::string tool = folder.path() / "ros2";
  std::ofstream(tool) << "sleep 1000; true\n";
  const Respawning launcher("sh " + tool + " run package program");
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  const int first = launcher.child();
  c.supervisor->adopt(ComponentId(0), first, live_now());
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_EQ(c.start(), 0) << "a second one was started";
  EXPECT_NE(launcher.child(first), 0);
}

int a_child_of(int launcher) {
  int child = 0;
  while (child == 0) {
    for (const Relative& each : descendants_of(launcher)) child = each.pid;
  }
  return child;
}

// As ros2 launch does where the launch file says on_exit=Shutdown().
TEST(Supervisor, TellsHowALauncherEndedAndWhetherItRanOthers) {
  for (const bool runs_others : {false, true}) {
    Supervised c("sleep 1000");
    const std::string others = runs_others ? "sleep 30 & " : "";
    const auto launcher =
        spawn({{"sh", "-c", others + "sleep 1000 & wait $!; exit 0"}, {}, "/dev/null"});
    ASSERT_TRUE(launcher);
    int child = 0;
    while (child == 0) {
      for (const Relative& each : descendants_of(*launcher)) {
        std::ifstream command("/proc/" + std::to_string(each.pid) + "/cmdline", std::ios::binary);
        std::string text(std::istreambuf_iterator<char>(command), {});
        if (text.find("1000") != std::string::npos && text.starts_with("sleep")) child = each.pid;
      }
    }
    c.supervisor->adopt(ComponentId(0), child, live_now());
    EXPECT_FALSE(c.launcher().has_ended);
    kill(child, SIGKILL);
    const LauncherSeen seen = c.launcher();
    EXPECT_TRUE(seen.has_ended);
    EXPECT_FALSE(seen.has_crashed);
    EXPECT_EQ(seen.ran_others, runs_others);
    waitpid(*launcher, nullptr, 0);
  }
}

// Two simulated robots of one user have the same state folder.
TEST(Supervisor, RobotsThatShareAFolderNoteTheirLaunchersApart) {
  Supervised one("sleep 1000", "0/one");
  Supervised two("sleep 1000", "0/two");
  ASSERT_EQ(one.folder(), two.folder());
  std::vector<int> launchers;
  for (Supervised* each : {&one, &two}) {
    const auto launcher = spawn({{"sh", "-c", "sleep 1000 & wait"}, {}, "/dev/null"});
    ASSERT_TRUE(launcher);
    launchers.push_back(*launcher);
    each->supervisor->adopt(ComponentId(0), a_child_of(*launcher), live_now());
  }
  EXPECT_EQ(noted_launch(one.folder(), "0/one/c").launcher, launchers[0]);
  EXPECT_EQ(noted_launch(two.folder(), "0/two/c").launcher, launchers[1]);
  for (const int launcher : launchers) {
    kill(a_child_of(launcher), SIGKILL);
    kill(launcher, SIGKILL);
    waitpid(launcher, nullptr, 0);
  }
}

TEST(Supervisor, RobotsThatShareAFolderHaveLogsOfTheirOwn) {
  Supervised one("sh -c 'echo of one; exec sleep 1000'", "0/one");
  Supervised two("sh -c 'echo of two; exec sleep 1000'", "0/two");
  ASSERT_EQ(one.folder(), two.folder());
  one.start();
  two.start();
  EXPECT_EQ(one.log_when("of one\n"), "of one\n");
  EXPECT_EQ(two.log_when("of two\n"), "of two\n");
}

// A terminal with a shell that runs a program as a job, in the foreground or not.
class Terminal {
 public:
  explicit Terminal(bool in_foreground,
                    const std::vector<std::string>& command = {"sleep", "1000"}) {
    shell_ = forkpty(&keyboard_, nullptr, nullptr, nullptr);
    if (shell_ != 0) return;
    const pid_t job = fork();
    if (job == 0) {
      setpgid(0, 0);
      signal(SIGINT, SIG_DFL);  // a test in the background inherits that it is ignored
      signal(SIGTSTP, SIG_DFL);
      signal(SIGTTOU, SIG_IGN);
      if (in_foreground) tcsetpgrp(STDIN_FILENO, getpid());
      std::vector<char*> arguments;
      for (const std::string& each : command) arguments.push_back(const_cast<char*>(each.c_str()));
      arguments.push_back(nullptr);
      execvp(arguments.front(), arguments.data());
    }
    while (true) pause();  // it reaps nothing: how the job ended can be read
  }
  ~Terminal() {
    if (shell_ <= 0) return;
    if (job_ != 0) kill(job_, SIGKILL);
    end(shell_);
    waitpid(shell_, nullptr, 0);
    close(keyboard_);
  }
  bool is_open() const { return shell_ > 0; }
  // Once it runs that program.
  int job(const std::string& program = "sleep") {
    job_ = a_child_of(shell_);
    EXPECT_TRUE(becomes(job_, program));
    return job_;
  }
  void press_ctrl_c() const { EXPECT_EQ(write(keyboard_, "\x03", 1), 1); }
  void press_ctrl_z() const { EXPECT_EQ(write(keyboard_, "\x1a", 1), 1); }

 private:
  int keyboard_ = -1;
  pid_t shell_ = -1;
  pid_t job_ = 0;
};

// As `ros2 run`: the shell goes on, and nothing of a launch ends with it.
TEST(Supervisor, CtrlCInTheTerminalOfANodeIsAPersonsOrder) {
  Terminal terminal(true);
  if (!terminal.is_open()) GTEST_SKIP() << "this system has no terminals";
  Supervised c("sleep 1000");
  c.supervisor->adopt(ComponentId(0), terminal.job(), live_now());
  EXPECT_FALSE(c.launcher().has_ended);
  terminal.press_ctrl_c();
  const ProcessSeen ended = c.state(ProcessState::kGone);
  EXPECT_EQ(ended.cause, Cause::kOrder) << ended.remark;
}

TEST(Supervisor, AJobThatCrashesOrRunsInTheBackgroundWasNotEndedByCtrlC) {
  for (const bool in_foreground : {true, false}) {
    Terminal terminal(in_foreground);
    if (!terminal.is_open()) GTEST_SKIP() << "this system has no terminals";
    Supervised c("sleep 1000");
    const int job = terminal.job();
    c.supervisor->adopt(ComponentId(0), job, live_now());
    EXPECT_FALSE(c.launcher().has_ended);
    kill(job, in_foreground ? SIGSEGV : SIGINT);
    const ProcessSeen ended = c.state(ProcessState::kGone);
    EXPECT_EQ(ended.cause, in_foreground ? Cause::kFault : Cause::kWish) << ended.remark;
  }
}

// A node that shuts its context down a second time: an exception may end it, too, so in a launch that is in doubt.
TEST(Supervisor, APythonNodeMayAnswerCtrlCWithAnException) {
  const test::TestFolder folder;
  const std::string ready = (folder / "ready").native();
  std::ofstream(folder / "node.py") << "import sys, time\n"
                                       "try:\n"
                                       "  open(sys.argv[1], 'w').close()\n"
                                       "  time.sleep(1000)\n"
                                       "except KeyboardInterrupt:\n"
                                       "  raise RuntimeError('shut down already')\n";
  const std::vector<std::string> node{"python3", (folder / "node.py").native(), ready};
  for (const bool in_foreground : {true, false}) {
    std::filesystem::remove(ready);
    Terminal terminal(in_foreground, node);
    if (!terminal.is_open()) GTEST_SKIP() << "this system has no terminals";
    const int job = terminal.job("");
    for (int tries = 0; tries < 1000 && !std::filesystem::exists(ready); ++tries)
      std::this_thread::sleep_for(10ms);
    ASSERT_TRUE(std::filesystem::exists(ready));
    Supervised c("sleep 1000");
    c.supervisor->adopt(ComponentId(0), job, live_now());
    EXPECT_FALSE(c.launcher().has_ended);
    kill(job, SIGINT);
    const ProcessSeen ended = c.state(ProcessState::kGone);
    EXPECT_EQ(ended.remark, "exit code 1");
    EXPECT_EQ(ended.cause, in_foreground ? Cause::kOrder : Cause::kDoubt);
  }
}

TEST(Supervisor, CtrlZInTheTerminalOfANodeIsAPersonsWish) {
  Terminal terminal(true);
  if (!terminal.is_open()) GTEST_SKIP() << "this system has no terminals";
  Supervised c("sleep 1000");
  const int job = terminal.job();
  c.supervisor->adopt(ComponentId(0), job, live_now());
  EXPECT_FALSE(c.launcher().has_ended);
  terminal.press_ctrl_z();
  EXPECT_EQ(c.state(ProcessState::kStopped).cause, Cause::kWish);
  kill(job, SIGCONT);
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, job);
}

// As systemctl freeze and docker pause do.
TEST(Supervisor, AProcessThatIsFrozenWithItsControlGroupWasStoppedOnAPersonsOrder) {
  const TestControlGroup group;
  if (!group.is_there()) GTEST_SKIP() << "this machine lets nobody make a control group";
  Supervised c("sleep 1000");
  const auto pid = spawn({{"sleep", "1000"}, {}, "/dev/null"});
  ASSERT_TRUE(pid);
  group.take(*pid);
  c.supervisor->adopt(ComponentId(0), *pid, live_now());
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, *pid);
  group.freeze();
  EXPECT_EQ(c.state(ProcessState::kStopped).cause, Cause::kOrder);
  group.freeze(false);
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, *pid);
  group.freeze();
  EXPECT_EQ(c.state(ProcessState::kStopped).cause, Cause::kOrder);
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone) << "as a person may order";
}

// A process that culprit starts while the launcher runs stands in for the launch, and its mark says
// so.
TEST(Supervisor, WhatItStartsWhileTheLauncherRunsStandsInForTheLaunch) {
  Supervised c("sleep 1000", "0/stand_in");
  const auto launcher = spawn({{"sh", "-c", "sleep 1000 & sleep 1001 & wait"}, {}, "/dev/null"});
  ASSERT_TRUE(launcher);
  const int child = a_child_of(*launcher);
  c.supervisor->adopt(ComponentId(0), child, live_now());
  kill(child, SIGKILL);
  c.state(ProcessState::kGone);
  const int pid = c.start();
  EXPECT_EQ(place_held_by(pid).launcher, *launcher);
  EXPECT_TRUE(place_held_by(pid).goes_on);
  // The next culprit knows it by its mark.
  c.supervise();
  const StartedHere again = c.started();
  EXPECT_EQ(again.pid, pid);
  EXPECT_EQ(again.launcher, *launcher);
  EXPECT_FALSE(c.launcher().has_ended);
  const auto listed = started_processes("0/stand_in");
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].component, "c");
  EXPECT_EQ(listed[0].launcher, *launcher);
  kill(*launcher, SIGKILL);
  waitpid(*launcher, nullptr, 0);
  const LauncherSeen ended = c.launcher();
  EXPECT_TRUE(ended.has_ended);
  EXPECT_TRUE(ended.has_crashed);
  EXPECT_FALSE(place_held_by(pid).goes_on);
  // A culprit that starts after the end receives it at once.
  c.supervise();
  EXPECT_TRUE(c.launcher().has_ended);
  // Unless another one had found that the process goes on.
  c.supervisor->stands_in_for_none(ComponentId(0));
  c.supervise();
  EXPECT_EQ(c.started().launcher, 0);
  c.supervisor->end_with_launch(ComponentId(0));
  EXPECT_EQ(c.state(ProcessState::kGone).cause, Cause::kWish);
  EXPECT_TRUE(started_processes("0/stand_in").empty());
}

// With no culprit there any more.
TEST(StartedProcesses, AreEndedAsALaunchEndsThem) {
  const test::TestFolder folder;
  const std::string script = folder.path() / "stubborn";
  std::ofstream(script) << "trap '' INT; sleep 1000 & while :; do wait; done\n";
  Supervised c("sh " + script, "0/left_behind");
  const int pid = c.start();
  const auto found = started_processes("0/left_behind");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pid, pid);
  EXPECT_EQ(found[0].launcher, 0);
  auto another = found;
  another[0].since -= 10s;  // a process that had the number before
  EXPECT_TRUE(end_processes(another).empty());
  EXPECT_EQ(started_processes("0/left_behind").size(), 1u);
  EXPECT_TRUE(end_processes(found).empty());
  EXPECT_TRUE(started_processes("0/left_behind").empty());
}

// Its launcher started another one meanwhile.
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

TEST(Supervisor, AStopThatIsMeantForAProcessNeverReachesItsSuccessor) {
  Supervised c("sleep 1000");
  const int first = c.start();
  kill(first, SIGKILL);
  c.state(ProcessState::kGone);
  const int second = c.start();
  c.supervisor->stop({9}, ComponentId(0), first, Ending::kToStartAgain);
  EXPECT_EQ(c.reply_to({9}).outcome, Outcome::kDone);
  EXPECT_EQ(kill(second, 0), 0);
  EXPECT_NE(state_letter(second).value_or('Z'), 'Z');
}

// Whether somebody wanted the end of a process, whichever program started it.
TEST(Supervisor, TellsWhetherAnEndWasWanted) {
  Supervised own("sleep 1000");
  kill(own.start(), SIGKILL);
  EXPECT_EQ(own.state(ProcessState::kGone).cause, Cause::kFault);
  kill(own.start(), SIGTERM);
  EXPECT_EQ(own.state(ProcessState::kGone).cause, Cause::kWish);
  kill(own.start(), SIGSTOP);
  EXPECT_EQ(own.state(ProcessState::kStopped).cause, Cause::kFault);
  own.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  const ProcessSeen by_culprit = own.state(ProcessState::kGone);
  EXPECT_EQ(by_culprit.remark, "killed by signal 9") << "it was stopped";
  EXPECT_EQ(by_culprit.cause, Cause::kWish);
}

TEST(Supervisor, ReportsTheStarterOfAProcessAndItsEnd) {
  Supervised c("sleep 1000");
  const auto launcher = spawn({{"sh", "-c", "sleep 1000 & wait"}, {}, "/dev/null"});
  ASSERT_TRUE(launcher);
  const int child = a_child_of(*launcher);
  c.supervisor->adopt(ComponentId(0), child, live_now());
  EXPECT_EQ(c.launcher().pid, *launcher);
  // Ctrl-Z stops both.
  kill(*launcher, SIGSTOP);
  kill(child, SIGSTOP);
  EXPECT_EQ(c.state(ProcessState::kStopped).cause, Cause::kWish);
  kill(child, SIGCONT);
  kill(*launcher, SIGKILL);
  waitpid(*launcher, nullptr, 0);
  const LauncherSeen seen = c.launcher();
  EXPECT_EQ(seen.pid, *launcher);
  EXPECT_TRUE(seen.has_ended);
  kill(child, SIGKILL);
  EXPECT_NE(c.state(ProcessState::kGone).cause, Cause::kWish);
}

// Before its parent received it, and, where the kernel keeps it, after that.
TEST(ProcessEnd, OfSomebodyElsesProcessIsToldByTheKernel) {
  const int pid = fork();
  if (pid == 0) {
    while (true) pause();
  }
  const FileDescriptor held(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  kill(pid, SIGABRT);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT);
  const ProcessEnd unheard = end_of(pid, held.get());
  EXPECT_EQ(unheard.remark, "killed by signal 6");
  EXPECT_EQ(unheard.cause, Cause::kFault);
  waitpid(pid, nullptr, 0);
  const ProcessEnd heard = end_of(pid, held.get());
  EXPECT_TRUE(heard.remark == "killed by signal 6" || heard.cause == Cause::kUnknown)
      << heard.remark;
}

TEST(ProcessEnd, IsAWishIfAPersonOrALauncherAsksSo) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    EXPECT_EQ(killed(signal).cause, Cause::kWish) << signal;
    EXPECT_EQ(exited(128 + signal).cause, Cause::kWish) << signal;
    EXPECT_EQ(exited(256 - signal).cause, Cause::kWish) << signal;
  }
  EXPECT_EQ(exited(0).cause, Cause::kWish);
  for (const int signal : {SIGKILL, SIGSEGV, SIGABRT, SIGBUS})
    EXPECT_EQ(killed(signal).cause, Cause::kFault) << signal;
  for (const int code : {1, 2, 134, 137, 139, 247})
    EXPECT_EQ(exited(code).cause, Cause::kFault) << code;
}

TEST(Supervisor, EndsNoOrphanThatNobodyWouldStartAgain) {
  Respawning launcher;
  Supervised c(Supervised::Declared{"RESPAWNED"});
  const int orphan = launcher.child();
  c.supervisor->adopt(ComponentId(0), orphan, live_now());
  launcher.end();
  const Reply reply = c.stop_to_start_again();
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_NE(reply.text.find("launcher of c has exited"), std::string::npos) << reply.text;
  EXPECT_TRUE(exists(orphan));
  kill(orphan, SIGKILL);
}

TEST(Supervisor, StartsNothingBesideALauncherThatItDoesNotKnow) {
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 2000\" RESPAWNED"});
  EXPECT_EQ(c.start(), 0);
}

// A node that writes megabytes a second, for ever.
TEST(Supervisor, KeepsTheEndOfALogAndNotAllOfIt) {
  Supervised c("sh -c 'while sleep 0.02; do seq 20000; done'");
  c.start();
  const std::filesystem::path older = c.folder() / "c.log.1";
  for (int tries = 0; tries < 6000 && !std::filesystem::exists(older); ++tries)
    std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(std::filesystem::exists(older));
  std::filesystem::remove(older);
  for (int tries = 0; tries < 6000 && !std::filesystem::exists(older); ++tries)
    std::this_thread::sleep_for(10ms);
  ASSERT_TRUE(std::filesystem::exists(older)) << "again and again";
  c.stop();
  EXPECT_LE(std::filesystem::file_size(older), kMostOfLog);
}

TEST(Supervisor, StartsAndStopsPolitely) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  EXPECT_TRUE(exists(pid));
  EXPECT_EQ(getpgid(pid), pid) << "it leads its own process group";
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
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

TEST(Supervisor, KillsWhatHangsSoon) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9") << "not by SIGTERM";
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, KillsSoonWhatIsKnownToHangOnlyWhileItIsEnded) {
  Supervised c("sh -c 'trap \\\"\\\" INT TERM; echo ready; while true; do sleep 0.1; done'");
  const int pid = c.start();
  c.log_when("ready");
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kToStartAgain);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(c.state(ProcessState::kGone).remark, "killed by signal 9") << "not by SIGTERM";
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
}

TEST(Supervisor, AnswersAllThatWaitForOneEnd) {
  Supervised c("sleep 1000");
  c.start();
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kDone);
}

// As `ros2 run` starts a node: the child works.
TEST(Supervisor, TellsThatWhatItStartedWorksUntilItsNodeIsThere) {
  Supervised c("sh -c 'while :; do :; done & wait'");
  const int pid = c.start();
  EXPECT_EQ(c.worked(), pid);
  EXPECT_EQ(c.worked(), pid) << "again";
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  EXPECT_TRUE(c.hears_of_no_work_for(2 * Supervisor::kWorkPeriod));
  c.stop();
}

TEST(Proc, AWaitingProcessDoesNotWork) {
  using namespace std::chrono_literals;
  const Work before{1s, 10 << 20};
  EXPECT_FALSE((Work{1s + 49ms, 10 << 20}.is_more_than(before)));
  EXPECT_FALSE((Work{900ms, 5 << 20}.is_more_than(before))) << "one of its processes has exited";
  EXPECT_TRUE((Work{1s + 50ms, 10 << 20}.is_more_than(before)));
  EXPECT_TRUE((Work{1s, 11 << 20}.is_more_than(before)));
}

// Checks the variables of SETUP and ENV, also PATH; and CWD.
TEST(Supervisor, StartsWithTheEnvironmentAndInTheFolderOfTheComponent) {
  Supervised c(Supervised::Declared{"LAUNCH \"my_node\" CWD /usr"});
  const std::filesystem::path program = c.folder() / "bin/my_node";
  std::filesystem::create_directories(program.parent_path());
  std::ofstream(program) << "#!/bin/sh\necho map $MAP in $(pwd)\nexec sleep 1000\n";
  std::filesystem::permissions(program, std::filesystem::perms(0755));
  c.environment = {{"MAP=yard", "PATH=" + program.parent_path().string() + ":/usr/bin:/bin"}};
  c.supervise();
  c.start();
  EXPECT_NE(c.log_when("\n").find("map yard in /usr\n"), std::string::npos);
  c.stop();
}

TEST(Supervisor, EndsNothingThatCouldNotBeStartedAgainForItsSetupOrItsFolder) {
  Supervised c(Supervised::Declared{"LAUNCH \"sleep 1000\" CWD /does/not/exist"});
  const int other = *spawn(Program{{"sleep", "1000"}, {}, "/dev/null"});
  c.supervisor->adopt(ComponentId(0), other, live_now());
  EXPECT_NE(c.stop_to_start_again().text.find("its folder /does/not/exist cannot be entered"),
            std::string::npos);
  c.environment = {Error{"SETUP /x failed"}};
  c.supervise();
  c.supervisor->adopt(ComponentId(0), other, live_now());
  const Reply refused = c.stop_to_start_again();
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_NE(refused.text.find("could not be started again: SETUP /x failed"), std::string::npos);
  EXPECT_TRUE(exists(other));
  c.supervisor.reset();
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
}

TEST(Supervisor, KillsAStoppedProcessAtOnce) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  kill(pid, SIGSTOP);
  EXPECT_EQ(c.state(ProcessState::kStopped).pid, pid);
  c.stop();
  EXPECT_FALSE(exists(pid));
}

TEST(WatchedProcess, OneThatADebuggerHoldsIsNotStopped) {
  const int pid = fork();
  ASSERT_GE(pid, 0);
  if (pid == 0) {
    while (true) pause();
  }
  const auto process = WatchedProcess::watch(pid, Relation::kChild);
  ASSERT_TRUE(process) << process.error();
  const bool may_trace = ptrace(PTRACE_SEIZE, pid, nullptr, nullptr) == 0;
  if (may_trace) {
    ptrace(PTRACE_INTERRUPT, pid, nullptr, nullptr);
    for (const Time end = live_now() + 20s; state_letter(pid) != 't' && live_now() < end;)
      std::this_thread::sleep_for(1ms);
    EXPECT_EQ(state_letter(pid), 't');
    EXPECT_EQ(process->state(), ProcessState::kRunning);
  }
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  if (!may_trace) GTEST_SKIP() << "no process may be traced here";
}

// A person looks at it; but what is to stop for good does.
// A process whose core dump takes a moment.
int with_much_memory(const test::TestFolder& folder) {
  const int pid = fork();
  if (pid != 0) return pid;
  constexpr std::size_t kBytes = std::size_t{384} << 20;
  const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
  if (chdir(folder.path().c_str()) != 0 || setrlimit(RLIMIT_CORE, &all) != 0) _exit(1);
  void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) _exit(1);
  std::memset(memory, 1, kBytes);
  close(creat("ready", 0600));
  while (true) pause();
}

TEST(Supervisor, WaitsForTheCoreDumpOfAProcessThatCrashed) {
  std::string pattern;
  std::ifstream("/proc/sys/kernel/core_pattern") >> pattern;
  if (pattern != "core") GTEST_SKIP() << "this machine writes core dumps elsewhere";
  const test::TestFolder folder;
  const int pid = with_much_memory(folder);
  while (!std::filesystem::exists(folder / "ready") && is_alive(pid))
    std::this_thread::sleep_for(10ms);
  Supervised c("sleep 1000");
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  kill(pid, SIGSEGV);
  while (!core_dump_of(pid)) {
    if (!is_alive(pid)) GTEST_SKIP() << "this machine writes no core dump, or in no time";
  }
  c.supervisor->stop({7}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  EXPECT_EQ(c.missing(),
            "the core dump of its crashed process " + std::to_string(pid) + " is not complete");
  EXPECT_EQ(c.reply_to({7}).outcome, Outcome::kRefused);
  c.supervisor->stop({8}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  c.nothing_missing();
  EXPECT_EQ(c.reply_to({8}).outcome, Outcome::kDone);
  std::uintmax_t dumped = 0;
  for (const auto& each : std::filesystem::directory_iterator(folder.path()))
    dumped = std::max(dumped, each.file_size());
  EXPECT_GE(dumped, std::uintmax_t{384} << 20) << "it is cut";
}

TEST(Supervisor, DoesNotReplaceWhatADebuggerHolds) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  if (ptrace(PTRACE_SEIZE, pid, nullptr, nullptr) != 0)
    GTEST_SKIP() << "no process may be traced here";
  ptrace(PTRACE_INTERRUPT, pid, nullptr, nullptr);
  for (const Time end = live_now() + 20s; state_letter(pid) != 't' && live_now() < end;)
    std::this_thread::sleep_for(1ms);
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kToStartAgain, Hangs::kYes);
  const Reply refused = c.reply_to({3});
  EXPECT_EQ(refused.outcome, Outcome::kRefused);
  EXPECT_NE(refused.text.find("is not replaced while a debugger holds it"), std::string::npos)
      << refused.text;
  EXPECT_TRUE(exists(pid));
  c.supervisor->stop({4}, ComponentId(0), 0, Ending::kForGood, Hangs::kYes);
  EXPECT_EQ(c.reply_to({4}).outcome, Outcome::kDone);
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
  const int pid = c.start();
  c.supervisor->adopt(ComponentId(0), pid, live_now());
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
}

// Its node is not there yet: by one that was killed, or on a slow machine.
TEST(Supervisor, AStartThatMeetsWhatIsComingUpIsThatStart) {
  const std::string robot = "test/" + std::to_string(getpid()) + "/meets";
  auto first = std::make_unique<Supervised>("sleep 1000", robot);
  const int pid = first->start();
  first->supervisor.reset();
  Supervised second("sleep 1000", robot);
  EXPECT_EQ(second.state(ProcessState::kRunning).pid, pid);
  second.supervisor->start({3}, ComponentId(0));
  const Reply reply = second.reply_to({3});
  EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
  EXPECT_EQ(std::get<Value>(reply.value), Value(std::int64_t{pid}));

  second.supervisor->adopt(ComponentId(0), pid, live_now());
  second.supervisor->start({4}, ComponentId(0));
  EXPECT_EQ(second.reply_to({4}).outcome, Outcome::kRefused) << "its node is there";
}

TEST(Supervisor, AdoptsAndEndsAProcessThatWasThere) {
  Supervised c("sleep 1000");
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null"});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt(ComponentId(0), *foreign, live_now());
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, *foreign);
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign)) << "what is a child of this program is reaped, too";
}

// One that a launch file started, too.
TEST(Supervisor, WithdrawsWhatItStartedAndNothingElse) {
  for (const bool is_of_earlier_one : {false, true}) {
    Supervised one("sh -c 'sleep 300 & wait'", "test/" + std::to_string(getpid()) + "/withdrawn");
    const int ours = one.start();
    if (is_of_earlier_one) {
      one.supervise();
      EXPECT_EQ(one.state(ProcessState::kRunning).pid, ours);
    }
    const Respawning launcher;
    const int other = launcher.child();
    one.supervisor->adopt(ComponentId(0), other, live_now());
    std::set<int> started;
    while (started.size() < 2) started = one.supervisor->started(ComponentId(0));
    EXPECT_TRUE(started.contains(ours));
    EXPECT_FALSE(started.contains(other));
    one.supervisor->withdraw(ComponentId(0));
    EXPECT_TRUE(one.supervisor->started(ComponentId(0)).empty()) << "it is asked once";
    EXPECT_EQ(one.state(ProcessState::kGone).pid, ours);
    EXPECT_TRUE(is_alive(other));
    EXPECT_FALSE(one.supervisor->has_started(ComponentId(0)));
    one.supervisor->withdraw(ComponentId(0));
    std::this_thread::sleep_for(50ms);
    EXPECT_TRUE(is_alive(other));
  }
}

TEST(Supervisor, LeavesItsProcessesRunningWhenItEnds) {
  int pid = 0;
  {
    const RuleSet rules = *check(Source("test.rules", "COMPONENT c LAUNCH \"sleep 1000\"\n")).rules;
    Inbox inbox;
    const test::TestFolder logs;
    Supervisor supervisor(rules, {logs.path(), {}}, inbox);
    supervisor.start({1}, ComponentId(0));
    std::vector<Observation> seen;
    for (const Time end = live_now() + 30s; pid == 0 && live_now() < end;) {
      inbox.take(end, seen);
      for (const Observation& o : seen) {
        if (const auto* process = std::get_if<ProcessSeen>(&o.what)) pid = process->pid;
      }
    }
  }
  ASSERT_NE(pid, 0);
  EXPECT_TRUE(exists(pid));
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

TEST(Launch, WhatRunsGoesOnWhetherOrNotAnybodyAsked) {
  const test::TestFolder own;
  const auto log = own / "log";
  int pid = 0;
  {
    const auto launch = Launch::begin({{"sleep", "1000"}, {}, log}, Until::kItRuns);
    ASSERT_TRUE(launch) << launch.error();
    pid = launch->pid();
    pollfd report{launch->descriptor(), POLLIN, 0};
    ASSERT_EQ(poll(&report, 1, 30'000), 1);
  }
  EXPECT_EQ(state_letter(pid).value_or('X') == 'Z', false);
  kill(pid, SIGKILL);
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED), 0) << "it is ours to reap";
}

// As after a crash: only the operating system's data are known.
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
  second.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(second.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
  EXPECT_NE(second.start(), pid);
}

// It leads a session of its own, and holds the device that the successor needs.
TEST(Supervisor, EndsWhatTheProcessHadStartedInASessionOfItsOwn) {
  const std::string robot = "test/tree/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid sleep 1000 & echo daemon $!; wait'", robot);
  const auto daemon_of = [&](std::size_t which) {
    std::string log;
    std::size_t at = 0;
    for (int tries = 0; tries < 1000; ++tries) {
      log = c.log_when("daemon ");
      at = std::string::npos;
      for (std::size_t i = 0, from = 0; i <= which; ++i, from = at + 1)
        at = log.find("daemon ", from);
      if (at != std::string::npos) break;
      std::this_thread::sleep_for(10ms);
    }
    return at == std::string::npos ? 0 : std::stoi(log.substr(at + 7));
  };
  const auto ends = [](int pid) {
    for (int tries = 0; tries < 1000 && is_alive(pid); ++tries) std::this_thread::sleep_for(10ms);
    return !is_alive(pid);
  };
  const int first = c.start();
  const int daemon = daemon_of(0);
  ASSERT_TRUE(becomes(daemon, "sleep"));
  c.stop();
  EXPECT_FALSE(exists(first));
  EXPECT_TRUE(ends(daemon));

  const int second = c.start();
  const int another = daemon_of(1);
  ASSERT_TRUE(becomes(another, "sleep"));
  kill(second, SIGKILL);  // by itself, as a node crashes
  c.state(ProcessState::kGone);
  EXPECT_TRUE(ends(another));
}

TEST(Supervisor, ADeviceThatSuchAChildHeldIsFreeForTheSuccessor) {
  const std::string robot = "test/device/" + std::to_string(getpid());
  const test::TestFolder folder;
  Supervised c("sh -c 'exec 9>" + (folder / "device").string() +
                   "; flock -n 9 || { echo busy; exit 7; }; setsid sleep 1000 & echo mine; wait'",
               robot);
  c.start();
  c.log_when("mine");
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  c.start();
  EXPECT_EQ(c.log_when("mine\nmine").find("busy"), std::string::npos);
}

// As above, and it forgets whose it is.
TEST(Supervisor, EndsWhatHasClearedItsEnvironment) {
  const std::string robot = "test/cleared/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid env -i sleep 1000 & echo daemon $!; wait'", robot);
  c.start();
  const std::string log = c.log_when("daemon ");
  const int daemon = std::stoi(log.substr(log.find("daemon ") + 7));
  ASSERT_TRUE(becomes(daemon, "sleep"));
  c.stop();
  for (int tries = 0; tries < 1000 && is_alive(daemon); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(daemon));
}

// A launch command may make a daemon and end: then that is the node.
TEST(Supervisor, WhatAProcessLeftThatEndedByItselfGoesOnUntilTheComponentIsStarted) {
  const std::string robot = "test/daemon/" + std::to_string(getpid());
  Supervised c("sh -c 'setsid sleep 1000 & echo daemon $!; sleep 0.2'", robot);
  c.start();
  const std::string log = c.log_when("daemon ");
  const int daemon = std::stoi(log.substr(log.find("daemon ") + 7));
  c.state(ProcessState::kGone);
  EXPECT_TRUE(is_alive(daemon));
  EXPECT_NE(c.start(), daemon) << "the component runs no more, so it can be started";
  for (int tries = 0; tries < 1000 && is_alive(daemon); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(daemon)) << "beside its successor";
}

// A component may be a culprit of its own, with components.
TEST(Supervisor, LeavesTheComponentsOfAnotherCulpritAlone) {
  const std::string robot = "test/inner/" + std::to_string(getpid());
  const test::TestFolder folder;
  const std::string script = (folder / "inner.sh").string();
  std::ofstream(script) << "export CULPRIT_COMPONENT=inner/x CULPRIT_PROCESS=$$\nexec sleep 1000\n";
  Supervised c("sh -c 'setsid sh " + script + " & echo inner $!; wait'", robot);
  c.start();
  const std::string log = c.log_when("inner ");
  const int inner = std::stoi(log.substr(log.find("inner ") + 6));
  ASSERT_TRUE(becomes(inner, "sleep"));
  c.stop();
  EXPECT_TRUE(is_alive(inner));
  end(inner);
}

TEST(Supervisor, AdoptsAProcessAgainOnlyIfItIsTheSameOne) {
  Supervised c("sleep 1000");
  const Time before = live_now() - 1s;
  const auto foreign = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(foreign);
  c.supervisor->adopt_again(ComponentId(0), *foreign, before);
  const int started = c.start();
  EXPECT_NE(started, *foreign) << "a reused PID is not adopted";
  c.stop();
  c.supervisor->adopt_again(ComponentId(0), *foreign, live_now());
  c.supervisor->start({3}, ComponentId(0));
  EXPECT_EQ(c.reply_to({3}).outcome, Outcome::kRefused);
  c.supervisor->stop({4}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({4}).outcome, Outcome::kDone);
  EXPECT_FALSE(exists(*foreign));
}

// Its node ran on another computer, or in a container.
TEST(Supervisor, AProcessThatWasNeverKnownDidNotEndUnseen) {
  Supervised c("sleep 1000");
  c.supervisor->adopt_again(ComponentId(0), 0, live_now());
  std::vector<Observation> seen;
  c.inbox.take(live_now(), seen);
  EXPECT_TRUE(seen.empty());
}

TEST(Supervisor, AProcessThatBeganLaterIsAnother) {
  Supervised c("sleep 1000");
  const auto stranger = spawn({{"sleep", "1000"}, {}, "/dev/null", {}});
  ASSERT_TRUE(stranger);
  c.supervisor->adopt(ComponentId(0), *stranger, live_now() - 1s);
  EXPECT_EQ(c.state(ProcessState::kGone).pid, *stranger)
      << "the former process with its PID has exited";
  c.stop();
  EXPECT_TRUE(exists(*stranger)) << "it is not culprit's to end";
  kill(*stranger, SIGKILL);
  waitpid(*stranger, nullptr, 0);
}

// ---- proof before harm

// No more than `count` while this exists.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(std::size_t count) {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit few = before_;
    few.rlim_cur = 200;
    setrlimit(RLIMIT_NOFILE, &few);
    for (int fd = 0; (fd = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)) >= 0;) taken_.emplace_back(fd);
    taken_.resize(taken_.size() - count);
  }
  ~DescriptorsLeft() { setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
  std::vector<FileDescriptor> taken_;
};

// Runs the program as somebody else's: neither our child nor marked.
int start_by_others(const std::string& command) {
  std::array<int, 2> told{};
  EXPECT_EQ(pipe(told.data()), 0);
  const int between = fork();
  if (between == 0) {
    const int pid = fork();
    if (pid == 0) {
      setsid();
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    [[maybe_unused]] const auto written = write(told[1], &pid, sizeof pid);
    _exit(0);
  }
  int pid = 0;
  EXPECT_EQ(read(told[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  close(told[0]);
  close(told[1]);
  waitpid(between, nullptr, 0);
  return pid;
}

TEST(Supervisor, EndsAndStartsAgainWhatCanBeStartedAgain) {
  Supervised c("sleep 1000");
  const int pid = c.start();
  EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kDone);
  EXPECT_FALSE(exists(pid));
  EXPECT_NE(c.start(), pid);
}

TEST(Supervisor, DoesNotEndWhatItCannotStartAgain) {
  const test::TestFolder folder;
  std::filesystem::copy_file("/bin/sleep", folder / "node");
  {
    Supervised c((folder / "node").string() + " 1000", "test/again/" + std::to_string(getpid()));
    const int pid = c.start();
    {
      const DescriptorsLeft none(0);
      const Reply reply = c.stop_to_start_again();
      EXPECT_EQ(reply.outcome, Outcome::kRefused);
      EXPECT_NE(reply.text.find("Too many open files"), std::string::npos) << reply.text;
    }
    EXPECT_TRUE(exists(pid));

    std::ofstream(folder / "no folder") << "";
    c.supervise(folder / "no folder");  // where no log can be written
    const Reply no_log = c.stop_to_start_again();
    EXPECT_EQ(no_log.outcome, Outcome::kRefused);
    EXPECT_NE(no_log.text.find("cannot be made: Not a directory"), std::string::npos)
        << no_log.text;
    EXPECT_TRUE(exists(pid));

    c.supervise();
    std::filesystem::remove(folder / "node");
    const Reply no_program = c.stop_to_start_again();
    EXPECT_EQ(no_program.outcome, Outcome::kRefused);
    EXPECT_EQ(no_program.text,
              "c is not ended, because it could not be started again: there is no program '" +
                  (folder / "node").string() + "', or it is not executable");
    EXPECT_TRUE(exists(pid));

    std::ofstream(folder / "node") << "#!/no/such/interpreter\n";
    std::filesystem::permissions(folder / "node", std::filesystem::perms::owner_all);
    EXPECT_EQ(c.stop_to_start_again().outcome, Outcome::kRefused);
    EXPECT_TRUE(exists(pid));
    c.stop();
    EXPECT_FALSE(exists(pid)) << "for good, it is ended all the same";
  }
}

// A process that others started is recognized by the program that it ran when it was found first.
TEST(Supervisor, DoesNotEndAnotherProgramThanTheComponentWas) {
  Supervised c("sleep 1000");
  const int node = start_by_others("exec sleep 1000");
  const int victim = start_by_others("exec tail -f /dev/null");
  ASSERT_TRUE(becomes(node, "sleep"));
  ASSERT_TRUE(becomes(victim, "tail"));
  c.supervisor->adopt(ComponentId(0), node, live_now());
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  EXPECT_EQ(c.reply_to({2}).outcome, Outcome::kDone);
  EXPECT_FALSE(is_alive(node));

  c.supervisor->adopt(ComponentId(0), victim, live_now());
  c.supervisor->stop({3}, ComponentId(0), 0, Ending::kForGood);
  const Reply reply = c.reply_to({3});
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_NE(reply.text.find("tail of user"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("sleep of user"), std::string::npos) << reply.text;
  EXPECT_TRUE(is_alive(victim));
  kill(victim, SIGKILL);
}

TEST(Supervisor, LeavesTheGroupOfSomebodyElseAloneAndSaysWhatStays) {
  Supervised c("sleep 1000");
  const int node = start_by_others("sleep 1000 & wait");
  std::vector<Relative> started;
  for (int tries = 0; tries < 3000 && started.empty(); ++tries) {
    started = descendants_of(node);
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_EQ(started.size(), 1u);
  const int child = started.front().pid;
  ASSERT_TRUE(becomes(child, "sleep"));
  c.supervisor->adopt(ComponentId(0), node, live_now());
  c.supervisor->stop({2}, ComponentId(0), 0, Ending::kForGood);
  const std::string told = c.trouble();
  EXPECT_EQ(told, "c was ended and left running: process " + std::to_string(child) + " (sleep)");
  EXPECT_FALSE(is_alive(node));
  EXPECT_TRUE(is_alive(child));
  kill(child, SIGKILL);
}

// A culprit that was killed had started it: its parent has exited, and the group is ours.
TEST(Supervisor, EndsTheGroupThatAnEarlierOneHadMade) {
  const std::string robot = "test/group/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  std::string marks = "CULPRIT_COMPONENT=" + robot + "/c CULPRIT_PROCESS_COUNTS_IN='" +
                      pid_namespace_of(getpid()) + "' ";
  const int node = start_by_others("exec env " + marks +
                                   "sh -c 'export CULPRIT_PROCESS=$$; exec sh -c \"sleep 1000 & "
                                   "sleep 1000 & wait\"'");
  std::vector<Relative> started;
  for (int tries = 0; tries < 3000 && started.size() < 2; ++tries) {
    started = descendants_of(node);
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_EQ(started.size(), 2u);
  c.supervise();
  EXPECT_EQ(c.state(ProcessState::kRunning).pid, node);
  kill(node, SIGKILL);  // by itself, as a node crashes
  EXPECT_EQ(c.state(ProcessState::kGone).pid, node);
  for (const Relative& each : started) {
    for (int tries = 0; tries < 3000 && is_alive(each.pid); ++tries)
      std::this_thread::sleep_for(10ms);
    EXPECT_FALSE(is_alive(each.pid)) << "it would go on beside the successor";
  }
}

// In another PID namespace the same number is another process.
TEST(Supervisor, AMarkCountsOnlyWhereItsNumberDoes) {
  const std::string robot = "test/namespace/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  const int stranger = start_by_others(
      "exec env CULPRIT_COMPONENT=" + robot +
      "/c CULPRIT_PROCESS_COUNTS_IN='pid:[1]' sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'");
  ASSERT_TRUE(becomes(stranger, "sleep"));
  c.supervise();
  EXPECT_NE(c.start(), stranger);
  EXPECT_TRUE(is_alive(stranger));
  kill(stranger, SIGKILL);
}

// Two simulated robots of one name and domain, each in a network of its own, are two robots.
TEST(Supervisor, AMarkCountsOnlyInItsNetwork) {
  const std::string robot = "test/network/" + std::to_string(getpid());
  const auto started_in = [&](const std::string& network) {
    return start_by_others("exec env CULPRIT_COMPONENT=" + robot +
                           "/c CULPRIT_PROCESS_COUNTS_IN='" + pid_namespace_of(getpid()) +
                           "' CULPRIT_NETWORK='" + network +
                           "' sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'");
  };
  const int other = started_in("net:[1]");
  ASSERT_TRUE(becomes(other, "sleep"));
  EXPECT_FALSE(carries_mark(other, robot + "/c"));
  EXPECT_TRUE(launched_as(robot + "/c").empty());
  EXPECT_TRUE(marked_processes(robot + "/").empty());
  const int own = started_in(network_namespace_of(getpid()));
  ASSERT_TRUE(becomes(own, "sleep"));
  EXPECT_EQ(launched_as(robot + "/c"), std::vector{own});
  kill(other, SIGKILL);
  kill(own, SIGKILL);
}

// Between fork() and execve() a process carries no mark yet.
TEST(Supervisor, StartsNothingWhileAnotherCulpritStartsIt) {
  Supervised c("sleep 1000");
  std::filesystem::create_directories(c.folder());
  const int lock = open((c.folder() / "c.start").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  c.supervisor->start({1}, ComponentId(0));
  const Reply reply = c.reply_to({1});
  EXPECT_EQ(reply.outcome, Outcome::kUnreachable);
  EXPECT_NE(reply.text.find("is being started already"), std::string::npos) << reply.text;
  close(lock);
  EXPECT_NE(c.start(), 0);
}

// A reader of the log, for example an older culprit, may lock it for as long as it likes.
TEST(Supervisor, RobotsThatShareAFolderDoNotWaitForOneAnothersStarts) {
  Supervised one("sleep 1000", "0/alpha");
  std::filesystem::create_directories(one.folder());
  const int lock =
      open((one.folder() / "0-beta-c.start").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  EXPECT_NE(one.start(), 0);
  EXPECT_TRUE(std::filesystem::exists(one.folder() / "0-alpha-c.start"));
  close(lock);
}

TEST(Supervisor, WaitsForNoLockOfAReaderOfItsLog) {
  Supervised c("sleep 1000");
  std::filesystem::create_directories(c.folder());
  const std::string log = c.folder() / "c.log";
  close(open(log.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
  const int reader = open(log.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(reader, LOCK_SH), 0);
  EXPECT_NE(c.start(), 0);
  for (const char* each : {"c.log", "c.start"}) {
    struct stat status {};
    ASSERT_EQ(stat((c.folder() / each).c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u) << each;
  }
  close(reader);
}

// The service is (OOMScoreAdjust=), so that it can heal what the kernel ends.
TEST(Supervisor, WhatItStartsIsNotSparedWhenMemoryRunsOut) {
  constexpr const char* kOwn = "/proc/self/oom_score_adj";
  std::string before;
  std::ifstream(kOwn) >> before;
  if (!(std::ofstream(kOwn) << "-100" << std::flush))
    GTEST_SKIP() << "only root may be spared more than before";
  Supervised c("sleep 1000");
  const int pid = c.start();
  std::ofstream(kOwn) << before << std::flush;
  ASSERT_TRUE(becomes(pid, "sleep"));
  std::string adjusted;
  std::ifstream("/proc/" + std::to_string(pid) + "/oom_score_adj") >> adjusted;
  EXPECT_EQ(adjusted, "0");
}

// A log may be a device, which is everybody's.
TEST(Supervisor, LeavesADeviceAsItIs) {
  const auto mode_of_null = [] {
    struct stat status {};
    EXPECT_EQ(stat("/dev/null", &status), 0);
    return status.st_mode & 07777;
  };
  const mode_t before = mode_of_null();
  const int pid = *spawn(Program{{"true"}, {}, "/dev/null"});
  waitpid(pid, nullptr, 0);
  EXPECT_EQ(mode_of_null(), before);
}

// Any user can start a process with these variables.
TEST(Supervisor, AMarkOfAnotherUsersProcessDoesNotCount) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const std::string robot = "test/stranger/" + std::to_string(getpid());
  Supervised c("sleep 1000", robot);
  const std::string variables = "env CULPRIT_COMPONENT=" + robot +
                                "/c CULPRIT_PROCESS_COUNTS_IN=\"$(readlink /proc/self/ns/pid)\" "
                                "sh -c 'export CULPRIT_PROCESS=$$; exec sleep 1000'";
  const int stranger =
      start_by_others("exec setpriv --reuid=65534 --regid=65534 --clear-groups " + variables);
  const int own = start_by_others("exec " + variables);
  ASSERT_TRUE(becomes(stranger, "sleep") && becomes(own, "sleep"));
  EXPECT_EQ(launched_as(robot + "/c"), std::vector{own}) << "and of our user it does";
  end(own);
  c.supervise();
  EXPECT_NE(c.start(), stranger);
  EXPECT_TRUE(is_alive(stranger));
  kill(stranger, SIGKILL);
}

// As on a file system that does not answer: a script whose interpreter is a pipe without a writer
// would hang; so does a program on a stopped server. Here the log is what the child waits for.
TEST(Supervisor, WaitsForNoFileSystemOfAProgram) {
  Supervised c("sleep 1000");
  Program program{{"sleep", "1000"}, {}, c.folder() / "pipe", {}, {}};
  std::filesystem::create_directories(c.folder());
  ASSERT_EQ(mkfifo(program.log.c_str(), 0600), 0);  // opening it waits for a reader
  auto launch = Launch::begin(program, Until::kItRuns);
  ASSERT_TRUE(launch) << launch.error();
  pollfd report{launch->descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&report, 1, 100), 0) << "it is not there yet, and we are here";
  const int pid = launch->pid();
  *launch = std::move(*Launch::begin({{"true"}, {}, c.folder() / "log"}, Until::kItCouldRun));
  for (int tries = 0; tries < 3000 && is_alive(pid); ++tries) std::this_thread::sleep_for(10ms);
  EXPECT_FALSE(is_alive(pid)) << "what is given up is killed";
  EXPECT_TRUE(launch->outcome());
}

TEST(Supervisor, NothingRunsThatCannotBeWatched) {
  while (waitpid(-1, nullptr, WNOHANG) > 0) continue;  // what other tests gave up
  Supervised c("sleep 1000");
  for (const std::size_t left : {0, 1, 2, 3, 4, 5}) {
    const DescriptorsLeft few(left);
    c.supervisor->start({4}, ComponentId(0));
    if (c.reply_to({4}).outcome == Outcome::kDone) {
      c.stop();
    } else {
      EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "there is no child with " << left;
    }
  }
}

TEST(Supervisor, AProcessWhoseMainThreadEndedRuns) {
  const int pid = fork();
  if (pid == 0) {
    std::thread([] { pause(); }).detach();
    syscall(SYS_exit, 0);  // of this thread alone
  }
  for (int tries = 0; tries < 3000 && state_letter(pid) != 'Z'; ++tries)
    std::this_thread::sleep_for(10ms);
  const auto process = WatchedProcess::watch(pid, Relation::kAdopted);
  ASSERT_TRUE(process);
  EXPECT_EQ(process->state(), ProcessState::kRunning);
  kill(pid, SIGKILL);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT);
  EXPECT_EQ(process->state(), ProcessState::kGone) << "a zombie is no process";
  waitpid(pid, nullptr, 0);
}

TEST(Proc, APythonNodeIsItsScript) {
  const test::TestFolder own;
  const auto script = own / "script";
  std::ofstream(script) << "sleep 1000; true\n";
  const int pid = start_by_others("exec bash -e " + script.string());
  ASSERT_TRUE(becomes(pid, "bash"));
  EXPECT_EQ(identity_of(pid)->script, script.string());
  EXPECT_EQ(identity_of(pid)->user, geteuid());
  kill(-pid, SIGKILL);
}

TEST(Spawn, PassesArgumentsAsTheyAre) {
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid = spawn({{"printf", "%s|", "a b", "$HOME", "; rm", "*"}, {}, log});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "a b|$HOME|; rm|*|");
}

TEST(Spawn, TellsTheProgramItsPid) {
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid =
      spawn({{"sh", "-c", "sh -c 'echo $CULPRIT_PROCESS'"}, {}, log, {}, "CULPRIT_PROCESS"});
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), std::to_string(*pid) + "\n");
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
  const test::TestFolder own;
  const auto log = own / "log";
  const auto pid = spawn({{"grep", "CapAmb", "/proc/self/status"}, {}, log});
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  ASSERT_TRUE(pid) << pid.error();
  waitpid(*pid, nullptr, 0);
  std::ifstream file(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "CapAmb:\t0000000000000000\n");
}

TEST(Spawn, SaysWhyAProgramCannotBeStarted) {
  const test::TestFolder folder;
  const auto bad = folder / "bad";
  std::ofstream(bad) << "#!/no/such/interpreter\n";
  std::filesystem::permissions(bad, std::filesystem::perms::owner_all);
  const auto pid = spawn({{bad}, {}, folder / "log"});
  ASSERT_FALSE(pid);
  EXPECT_EQ(pid.error(), "cannot start '" + bad.string() + "': No such file or directory");
}

}  // namespace
}  // namespace culprit::owners
