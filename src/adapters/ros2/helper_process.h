// A run of the helper program: a child process, and our end of the socket to it.
#pragma once

#include <memory>
#include <string>

#include "base/expected.h"
#include "ros2/helper_options.h"

namespace culprit::ros2 {

class HelperProcess {
 public:
  // Errors: the program cannot be run.
  static Expected<std::unique_ptr<HelperProcess>> start(const HelperOptions& options);
  // Closes the socket, gives the process a moment to say goodbye to the robot, and kills it then.
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  int socket() const { return socket_; }  // does not block
  // Kills it now, and gives how it ended: "signal 9", "status 1".
  std::string end();

 private:
  HelperProcess(int pid, int socket) : pid_(pid), socket_(socket) {}

  int pid_;  // 0: it was reaped
  int socket_;
};

}  // namespace culprit::ros2
