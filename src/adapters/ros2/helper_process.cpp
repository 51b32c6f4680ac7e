#include "ros2/helper_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace culprit::ros2 {
namespace {

constexpr int kItsSocket = 3;

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::string ending_of(int status) {
  return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                             : "status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

// In a process group of its own: the terminal's Ctrl-C is culprit's.
Expected<std::unique_ptr<HelperProcess>> HelperProcess::start(const HelperOptions& options) {
  if (options.command.empty()) return Error{"no helper program is named"};
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return Error{std::string("no socket for the helper program: ") + std::strerror(errno)};
  std::vector<std::string> words = options.command;
  words.push_back(std::to_string(kItsSocket));
  std::vector<std::string> variables = options.environment;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], kItsSocket);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  int pid = 0;
  const int failed = posix_spawn(&pid, words.front().c_str(), &files, &attributes,
                                 pointers_to(words).data(), pointers_to(variables).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    return Error{"cannot run the helper program " + options.command.front() + ": " +
                 std::strerror(failed)};
  }
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return std::unique_ptr<HelperProcess>(new HelperProcess(pid, ends[0]));
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
