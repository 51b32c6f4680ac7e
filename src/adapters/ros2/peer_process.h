// For tests: a program in a process of its own, whose lines can be awaited, and that can be killed.
#pragma once

#include <array>
#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "ros2/live_test.h"

namespace culprit::ros2 {

class PeerProcess {
 public:
  explicit PeerProcess(std::vector<std::string> command) {
    std::array<int, 2> pipe_fds{};
    if (pipe2(pipe_fds.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe_fds[1], STDOUT_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int failed =
        posix_spawnp(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pipe_fds[1]);
    if (failed != 0) throw std::runtime_error("cannot start " + command[0]);
    reading_ = std::thread([this, fd = pipe_fds[0]] { read_lines(fd); });
  }

  ~PeerProcess() {
    if (pid_ != 0) end(SIGKILL);
    reading_.join();
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  int pid() const { return pid_; }
  rtps::EventLog<std::string>& lines() { return lines_; }

  bool says(const std::string& line) {
    return lines_.wait_for_one([&](const std::string& said) { return said == line; });
  }

  // Sends the signal, and waits for the end. The status as waitpid gives it.
  int end(int signal) {
    kill(pid_, signal);
    return wait();
  }
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return status;
  }

 private:
  void read_lines(int fd) {
    std::string line;
    std::array<char, 256> buffer;
    for (ssize_t size = 0; (size = read(fd, buffer.data(), buffer.size())) > 0;) {
      for (ssize_t i = 0; i < size; ++i) {
        const char c = buffer[static_cast<std::size_t>(i)];
        if (c == '\n') {
          lines_.add(std::exchange(line, {}));
        } else {
          line += c;
        }
      }
    }
    close(fd);
  }

  pid_t pid_ = 0;
  rtps::EventLog<std::string> lines_;
  std::thread reading_;
};

}  // namespace culprit::ros2
