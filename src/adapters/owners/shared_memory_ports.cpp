#include "owners/shared_memory_ports.h"

#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <utility>

namespace culprit::owners {
namespace {

// "/dev/shm/fastrtps_port7415_el"; Fast DDS 3 writes "fastdds".
bool is_lock_of_port(const std::string& file) {
  return (file.starts_with("/dev/shm/fastrtps_port") ||
          file.starts_with("/dev/shm/fastdds_port")) &&
         file.ends_with("_el") && file.rfind('/') == sizeof("/dev/shm") - 1;
}

}  // namespace

void SharedMemoryPorts::note(int pid) {
  std::vector<std::string> locks;
  std::error_code failed;
  const std::filesystem::path folder = "/proc/" + std::to_string(pid) + "/fd";
  std::filesystem::directory_iterator files(folder, failed);
  for (; !failed && files != std::filesystem::directory_iterator(); files.increment(failed)) {
    std::error_code is_gone;
    std::string file = std::filesystem::read_symlink(files->path(), is_gone);
    if (!is_gone && is_lock_of_port(file) && locks.size() < kMost) locks.push_back(std::move(file));
  }
  if (!locks.empty()) noted_[pid] = std::move(locks);
}

void SharedMemoryPorts::keep(int pid) {
  const auto noted = noted_.extract(pid);
  if (!noted) return;
  for (const std::string& file : noted.mapped()) {
    FileDescriptor lock(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    const bool is_free = lock && flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
    if (is_free) kept_.push_back(std::move(lock));
  }
  while (kept_.size() > kMost) kept_.pop_front();
}

}  // namespace culprit::owners
