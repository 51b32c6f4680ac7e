// A name that one process of this machine has at a time, whoever runs it.
//
// It is an abstract Unix socket, which the kernel gives to one process only and frees when that
// process ends, however it ends. There is no file to clean up.
#pragma once

#include <optional>
#include <string>

#include "language/expected.h"

namespace culprit::ros2 {

class NamedLock {
 public:
  // Nothing: another process has it. `name` is cut to the 100 characters that a socket's may have.
  static Expected<std::optional<NamedLock>> take(const std::string& name);

  NamedLock(NamedLock&& other) noexcept;
  NamedLock& operator=(NamedLock&& other) noexcept;
  ~NamedLock();

 private:
  explicit NamedLock(int socket) : socket_(socket) {}

  int socket_;  // -1 after a move
};

}  // namespace culprit::ros2
