// make demo, as a person sees it at a terminal: it stays until Ctrl-C, says how to break the robot, and leaves no process.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <poll.h>
#include <pty.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "exemplars/sunset/node_process.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

// A program that believes to be at a terminal.
class AtTerminal {
 public:
  explicit AtTerminal(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ != 0) return;
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  ~AtTerminal() {
    if (pid_ > 0 && waitpid(pid_, nullptr, WNOHANG) == 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(terminal_);
  }
  AtTerminal(const AtTerminal&) = delete;
  AtTerminal& operator=(const AtTerminal&) = delete;

  // Whether `text` stands, or comes to stand, in what it prints from this byte on.
  bool prints(const std::string& text, std::size_t from = 0) {
    const auto end = std::chrono::steady_clock::now() + TestProgram::kPatience;
    while (said_.find(text, from) == std::string::npos) {
      if (std::chrono::steady_clock::now() > end || !read_more()) return false;
    }
    return true;
  }
  // Presses Ctrl-C. The exit code; -1: it did not end by itself.
  int end_by_control_c() {
    constexpr char kControlC = '\3';
    if (write(terminal_, &kControlC, 1) != 1) return -1;
    const auto end = std::chrono::steady_clock::now() + TestProgram::kPatience;
    while (std::chrono::steady_clock::now() < end) {
      read_more();
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) != pid_) continue;
      pid_ = 0;
      return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return -1;
  }
  const std::string& said() const { return said_; }

 private:
  // Waits a moment for it. False: the terminal was closed.
  bool read_more() {
    constexpr int kMoment = 100;  // ms
    pollfd waits{terminal_, POLLIN, 0};
    if (poll(&waits, 1, kMoment) <= 0) return true;
    char part[4096];
    const ssize_t size = read(terminal_, part, sizeof part);
    if (size <= 0) return false;
    said_.append(part, static_cast<std::size_t>(size));
    return true;
  }

  pid_t pid_ = 0;
  int terminal_ = -1;
  std::string said_;
};

std::string laboratory() { return (own_folder() / "culprit-lab").string(); }

TEST(DemoAtATerminal, StaysUntilControlCAndLeavesNoProcess) {
  const TestWorld world;
  AtTerminal demo({laboratory(), "demo", "--scenario", "kill:camera"});
  ASSERT_TRUE(demo.prints("See it in a browser: http://127.0.0.1:")) << demo.said();
  ASSERT_TRUE(demo.prints("Break it yourself")) << demo.said();
  ASSERT_TRUE(demo.prints("pkill -KILL -f 'sunset-node camera'")) << demo.said();
  ASSERT_TRUE(demo.prints("culprit status --domain ")) << demo.said();

  // It is broken, and heals.
  const std::size_t before = demo.said().size();
  ASSERT_EQ(kill(pid_in(demo.said(), "camera"), SIGKILL), 0);
  EXPECT_TRUE(demo.prints("redeploy camera: done", before)) << demo.said();
  EXPECT_TRUE(demo.prints("RGBDead resolved", before)) << demo.said();

  EXPECT_EQ(demo.end_by_control_c(), 0) << demo.said();
  const std::string said = "SUNSET is on domain ";
  const int domain = std::atoi(demo.said().c_str() + demo.said().find(said) + said.size());
  for (const sunset::Member member : sunset::kMembers) {
    const auto left = sunset::processes_of(member, static_cast<std::uint32_t>(domain));
    EXPECT_TRUE(left.empty()) << sunset::name_of(member);
  }
}

TEST(DemoAtATerminal, EndsByItselfInAPipe) {
  const TestWorld world;
  TestProgram demo(world, {"culprit-lab", "demo", "--scenario", "kill:camera", "--port", "0"});
  EXPECT_EQ(demo.wait(), 0) << demo.output();
  EXPECT_THAT(demo.output(), HasSubstr("healed"));
  EXPECT_THAT(demo.output(), testing::Not(HasSubstr("Break it yourself")));
}

}  // namespace
}  // namespace culprit::cli
