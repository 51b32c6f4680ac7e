#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <pty.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "owners/spawn.h"
#include "owners/supervisor.h"
#include "owners/test_control_group.h"
#include "owners/test_process.h"
#include "owners/test_supervised.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

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

}  // namespace
}  // namespace culprit::owners
