// A control group of a test, which can be frozen.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace culprit::owners {

class TestControlGroup {
 public:
  enum class Version : std::uint8_t { k1, k2 };

  explicit TestControlGroup(Version version = Version::k2) : version_(version) {
    static int count = 0;
    const std::string name =
        "culprit-test-" + std::to_string(getpid()) + "-" + std::to_string(++count);
    const std::filesystem::path all = "/sys/fs/cgroup";
    for (const std::filesystem::path& mount : version == Version::k1
                                                  ? std::vector{all / "freezer"}
                                                  : std::vector{all / "unified", all}) {
      std::error_code error;
      if (!std::filesystem::create_directory(mount / name, error)) continue;
      folder_ = mount / name;
      if (std::filesystem::exists(folder_ / file())) return;
      std::filesystem::remove(folder_, error);
      folder_.clear();
    }
  }
  // All processes in it must have ended.
  ~TestControlGroup() {
    if (!is_there()) return;
    freeze(false);
    std::error_code error;
    for (int tries = 0; tries < 500 && !std::filesystem::remove(folder_, error); ++tries)
      usleep(10'000);
  }
  TestControlGroup(const TestControlGroup&) = delete;
  TestControlGroup& operator=(const TestControlGroup&) = delete;

  // False: this machine lets nobody make one.
  bool is_there() const { return !folder_.empty(); }
  void take(int pid) const { std::ofstream(folder_ / "cgroup.procs") << pid << '\n'; }
  void freeze(bool on = true) const {
    std::ofstream(folder_ / file())
        << (version_ == Version::k2 ? (on ? "1" : "0") : (on ? "FROZEN" : "THAWED")) << '\n';
  }

 private:
  const char* file() const { return version_ == Version::k2 ? "cgroup.freeze" : "freezer.state"; }

  Version version_;
  std::filesystem::path folder_;
};

}  // namespace culprit::owners
