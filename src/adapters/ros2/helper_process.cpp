#include "ros2/helper_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "base/begin_program.h"

namespace culprit::ros2 {
namespace {

std::string ending_of(int status) {
  return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                             : "status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

Expected<std::unique_ptr<HelperProcess>> HelperProcess::start(const HelperOptions& options) {
  if (options.command.empty()) return Error{"no helper program is named"};
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return Error{std::string("no socket for the helper program: ") + std::strerror(errno)};
  std::vector<std::string> words = options.command;
  words.push_back(std::to_string(kSocketOfProgram));
  const auto pid =
      begin_program(std::move(words), options.environment,
                    {.in = -1, .out = STDOUT_FILENO, .err = STDERR_FILENO, .socket = ends[1]});
  close(ends[1]);
  if (!pid) {
    close(ends[0]);
    return Error{pid.error()};
  }
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return std::unique_ptr<HelperProcess>(new HelperProcess(*pid, ends[0]));
}

HelperProcess::~HelperProcess() {
  constexpr auto kGoodbye = std::chrono::milliseconds(500);
  constexpr auto kLook = std::chrono::milliseconds(10);
  close(socket_);
  const auto until = std::chrono::steady_clock::now() + kGoodbye;
  while (pid_ != 0 && std::chrono::steady_clock::now() < until) {
    if (waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = 0;
    if (pid_ != 0) std::this_thread::sleep_for(kLook);
  }
  if (pid_ != 0) end();
}

std::string HelperProcess::end() {
  if (pid_ == 0) return "it has ended";
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) {
    kill(pid_, SIGKILL);
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  pid_ = 0;
  return ending_of(status);
}

}  // namespace culprit::ros2
