// A file descriptor with an owner.
#pragma once

#include <poll.h>
#include <unistd.h>
#include <utility>

namespace culprit::owners {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

// Whether a read would not wait.
inline bool is_readable(int descriptor) {
  pollfd file{descriptor, POLLIN, 0};
  return poll(&file, 1, 0) > 0;
}

}  // namespace culprit::owners
