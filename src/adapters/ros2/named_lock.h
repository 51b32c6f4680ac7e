// A name that one process of this machine holds at a time, whichever user runs it.
//
// It is an abstract Unix socket, which the kernel gives to one process only and frees when that
// process exits. There is no file to clean up. Any process on the machine may take any name;
// holder() gives the process that has it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/expected.h"

namespace culprit::ros2 {

class NamedLock {
 public:
  // As the kernel recorded it when the process took the name.
  struct Holder {
    int pid = 0;  // 0: in another PID namespace
    std::uint32_t user = 0;
  };

  // Nothing: another process has it. If `name` is longer than a socket's name may be, a hash
  // replaces its end.
  static Expected<std::optional<NamedLock>> take(const std::string& name);
  // Nothing: no process has it, or that process has not called admit() for too long.
  static std::optional<Holder> holder(const std::string& name);

  NamedLock(NamedLock&& other) noexcept;
  NamedLock& operator=(NamedLock&& other) noexcept;
  ~NamedLock();

  // Makes room for others that ask who holds it: call it now and then.
  void admit();

 private:
  explicit NamedLock(int socket) : socket_(socket) {}

  int socket_;  // -1 after a move
};

}  // namespace culprit::ros2
