#include "owners/shared_memory_ports.h"

#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/file.h>
#include <utility>

namespace culprit::owners {
namespace {

// "fastrtps_port7415_el", and "fastdds_port7415_el" since Fast DDS 3.
bool is_lock_of_port(const std::string& file) {
  return (file.starts_with("/dev/shm/fastrtps_port") ||
          file.starts_with("/dev/shm/fastdds_port")) &&
         file.ends_with("_el");
}

}  // namespace

void SharedMemoryPorts::note(int pid) {
  std::error_code failed;
  const std::filesystem::path folder = "/proc/" + std::to_string(pid) + "/fd";
  std::filesystem::directory_iterator files(folder, failed);
  for (; !failed && files != std::filesystem::directory_iterator(); files.increment(failed)) {
    std::error_code is_gone;
    const std::string file = std::filesystem::read_symlink(files->path(), is_gone);
    if (is_gone || !is_lock_of_port(file) || noted_.size() >= kMost) continue;
    FileDescriptor lock(open(files->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (lock) noted_.push_back(std::move(lock));
  }
}

void SharedMemoryPorts::keep() {
  for (FileDescriptor& lock : std::exchange(noted_, {})) {
    const bool is_free = flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
    (is_free ? kept_ : noted_).push_back(std::move(lock));
  }
  while (kept_.size() > kMost) kept_.pop_front();
}

}  // namespace culprit::owners
