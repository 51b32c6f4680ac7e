// Stand-ins for systemd, for tests: a server that speaks its published interface on a real
// dbus-daemon, and systemd itself.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "owners/service_units.h"

namespace culprit::owners {

// A real dbus-daemon on a socket of its own; a program that looks for either bus meanwhile finds
// it.
class TestBus {
 public:
  TestBus();
  ~TestBus();
  const std::string& address() const { return address_; }
  void signal(int number) const;

 private:
  std::filesystem::path folder_;
  std::string address_;
  int pid_ = 0;
};

struct TestUnit {
  bool restarts = false;      // Restart=always
  bool heeds_signals = true;  // ends when it is asked politely
  bool is_broken = false;     // it ends at once, with an error
  std::string active = "inactive";
  int pid = 0;
  int last_pid = 0;
  std::string result = "success";
  // When its main process began, it was and ceased to be active, its main process ended, and it was inactive at last, in
  // microseconds.
  std::uint64_t began = 0;
  std::uint64_t entered_active = 0;
  std::uint64_t left_active = 0;
  std::uint64_t ended = 0;
  std::uint64_t became_inactive = 0;
  std::uint64_t runtime_max = UINT64_MAX;  // RuntimeMaxSec=
  std::uint64_t restart_delay = 100'000;   // RestartSec=
  // With RestartSteps=; before systemd 254 there is none.
  std::optional<std::uint64_t> next_restart_delay{};
  std::uint64_t conditions_checked = 0;  // in microseconds
};

// Speaks org.freedesktop.systemd1 on that bus, as far as culprit asks. A unit runs `sleep`, really.
class TestSystemd {
 public:
  explicit TestSystemd(const TestBus& bus);
  ~TestSystemd();

  void add(const std::string& name, TestUnit unit = {});
  // As `systemctl start`.
  int start(const std::string& name);
  int pid_of(const std::string& name);
  // The requests that it received, in order: "RestartUnit lidar.service".
  std::vector<std::string> asked();

  // Every request is refused with this D-Bus error; empty: none.
  void refuse(const std::string& error);
  // The state that it reports for all units in place of the truth; empty: the truth.
  void say(const std::string& active, std::uint32_t main_pid, bool has_job = false);

 private:
  friend struct TestSystemdMethods;
  void run();
  void reap() CULPRIT_REQUIRES(mutex_);
  void begin(const std::string& name) CULPRIT_REQUIRES(mutex_);
  void end(TestUnit& unit, int number);

  Mutex mutex_;
  std::map<std::string, TestUnit> units_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::string> asked_ CULPRIT_GUARDED_BY(mutex_);
  std::string refusal_ CULPRIT_GUARDED_BY(mutex_);
  std::string said_active_ CULPRIT_GUARDED_BY(mutex_);
  std::uint32_t said_pid_ CULPRIT_GUARDED_BY(mutex_) = 0;
  bool said_job_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::vector<std::string> to_start_
      CULPRIT_GUARDED_BY(mutex_);  // RestartUnit: once the old one has ended
  struct sd_bus* bus_ = nullptr;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

// systemd itself: a user instance with a dbus-daemon of its own, and only the units that a test
// writes. Needs the right to mount, and gives nothing where the machine does not grant it.
class UserSystemd {
 public:
  static std::unique_ptr<UserSystemd> begin();
  ~UserSystemd();

  // Writes the unit `name`, which runs `command`, and starts it. It writes a line for each start.
  void start(const std::string& name, const std::string& command, const std::string& settings);
  int starts_of(const std::string& name) const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  UserSystemd() = default;

  std::filesystem::path folder_;
  int pid_ = 0;
};

}  // namespace culprit::owners
