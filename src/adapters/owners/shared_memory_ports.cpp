#include "owners/shared_memory_ports.h"

#include <algorithm>
#include <fcntl.h>
#include <filesystem>
#include <optional>
#include <string_view>
#include <sys/file.h>
#include <utility>

namespace culprit::owners {
namespace {

constexpr const char* kFolder = "/dev/shm";

// "/dev/shm/fastrtps_port7415_el"; Fast DDS 3 writes "fastdds".
bool is_lock_of_port(const std::string& file) {
  return (file.starts_with("/dev/shm/fastrtps_port") ||
          file.starts_with("/dev/shm/fastdds_port")) &&
         file.ends_with("_el") && file.rfind('/') == std::string_view(kFolder).size();
}

// Returns nothing if a process holds the file, or it was removed.
std::optional<FileDescriptor> lock(const std::string& file) {
  FileDescriptor lock(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!lock || flock(lock.get(), LOCK_EX | LOCK_NB) != 0) return std::nullopt;
  return lock;
}

}  // namespace

void SharedMemoryPorts::keep_earlier() {
  std::vector<std::pair<std::filesystem::file_time_type, std::string>> by_age;
  std::error_code failed;
  std::filesystem::directory_iterator files(kFolder, failed);
  for (; !failed && files != std::filesystem::directory_iterator(); files.increment(failed)) {
    std::error_code is_gone;
    const auto written = files->last_write_time(is_gone);
    if (!is_gone && is_lock_of_port(files->path())) by_age.emplace_back(written, files->path());
  }
  std::sort(by_age.rbegin(), by_age.rend());
  for (const auto& [written, file] : by_age) {
    if (kept_.size() >= kMostOfEarlier) return;
    if (auto free = lock(file)) kept_.push_front(std::move(*free));
  }
}

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
    if (auto free = lock(file)) kept_.push_back(std::move(*free));
  }
  while (kept_.size() > kMost) kept_.pop_front();
}

}  // namespace culprit::owners
