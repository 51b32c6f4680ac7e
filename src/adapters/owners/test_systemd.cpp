#include "owners/test_systemd.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <systemd/sd-bus.h>

#include "owners/file_descriptor.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

constexpr const char* kPath = "/org/freedesktop/systemd1";
constexpr const char* kUnits = "/org/freedesktop/systemd1/unit";

int program(std::vector<std::string> arguments, const std::filesystem::path& log) {
  auto pid = spawn({std::move(arguments), {}, log});
  if (!pid) throw std::runtime_error(pid.error());
  return *pid;
}

std::string path_of(const std::string& name) {
  char* path = nullptr;
  sd_bus_path_encode(kUnits, name.c_str(), &path);
  const std::unique_ptr<char, decltype(&std::free)> owned(path, std::free);
  return path;
}

std::string name_of(const char* path) {
  char* name = nullptr;
  sd_bus_path_decode(path, kUnits, &name);
  const std::unique_ptr<char, decltype(&std::free)> owned(name, std::free);
  return name == nullptr ? "" : name;
}

// The file is there before anybody listens.
bool accepts(const std::filesystem::path& socket_file) {
  const FileDescriptor end(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_file.native().copy(address.sun_path, sizeof address.sun_path - 1);
  return connect(end.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

// ---- the bus

TestBus::TestBus() {
  std::string name = (std::filesystem::temp_directory_path() / "culprit-bus-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = name;
  address_ = "unix:path=" + (folder_ / "bus").string();
  pid_ = program({"dbus-daemon", "--session", "--nofork", "--nopidfile", "--address=" + address_},
                 folder_ / "log");
  for (const Time end = later(live_now(), 20s); !accepts(folder_ / "bus");) {
    if (live_now() > end) throw std::runtime_error("dbus-daemon does not begin");
    std::this_thread::sleep_for(10ms);
  }
  setenv("DBUS_SESSION_BUS_ADDRESS", address_.c_str(), 1);
  setenv("DBUS_SYSTEM_BUS_ADDRESS", address_.c_str(), 1);
}

TestBus::~TestBus() {
  unsetenv("DBUS_SESSION_BUS_ADDRESS");
  unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  std::filesystem::remove_all(folder_);
}

void TestBus::signal(int number) const { kill(pid_, number); }

// ---- what is asked of it

struct TestSystemdMethods {
  static TestSystemd& of(void* data) { return *static_cast<TestSystemd*>(data); }

  static int change(sd_bus_message* m, void* data, sd_bus_error* error) {
    TestSystemd& self = of(data);
    const char* name = nullptr;
    if (const int read = sd_bus_message_read(m, "s", &name); read < 0) return read;
    const MutexLock lock(self.mutex_);
    const std::string method = sd_bus_message_get_member(m);
    self.asked_.push_back(method + " " + name);
    if (!self.refusal_.empty()) return sd_bus_error_set(error, self.refusal_.c_str(), "not you");
    if (method == "SetUnitProperties") return sd_bus_reply_method_return(m, "");
    TestUnit& unit = self.units_[name];
    if (method == "KillUnit") {
      self.end(unit, SIGKILL);
      return sd_bus_reply_method_return(m, "");
    }
    if (method == "StopUnit") unit.restarts = false;
    if (method != "StartUnit" && unit.pid != 0) {
      if (unit.heeds_signals) self.end(unit, SIGTERM);
      if (method == "RestartUnit") self.to_start_.push_back(name);
    } else if (method != "StopUnit") {
      self.begin(name);
    }
    return sd_bus_reply_method_return(m, "o", "/org/freedesktop/systemd1/job/1");
  }

  static int load(sd_bus_message* m, void*, sd_bus_error*) {
    const char* name = nullptr;
    if (const int read = sd_bus_message_read(m, "s", &name); read < 0) return read;
    return sd_bus_reply_method_return(m, "o", path_of(name).c_str());
  }

  static int by_pid(sd_bus_message* m, void* data, sd_bus_error* error) {
    TestSystemd& self = of(data);
    std::uint32_t pid = 0;
    if (const int read = sd_bus_message_read(m, "u", &pid); read < 0) return read;
    const MutexLock lock(self.mutex_);
    for (const auto& [name, unit] : self.units_) {
      if (static_cast<std::uint32_t>(unit.pid) == pid)
        return sd_bus_reply_method_return(m, "o", path_of(name).c_str());
    }
    return sd_bus_error_set(error, "org.freedesktop.systemd1.NoUnitForPID", "of none");
  }

  static int files(sd_bus_message* m, void* data, sd_bus_error*) {
    TestSystemd& self = of(data);
    const MutexLock lock(self.mutex_);
    sd_bus_message* reply = nullptr;
    sd_bus_message_new_method_return(m, &reply);
    sd_bus_message_open_container(reply, 'a', "(ss)");
    for (const auto& [name, unit] : self.units_)
      sd_bus_message_append(reply, "(ss)", ("/etc/systemd/system/" + name).c_str(), "enabled");
    sd_bus_message_close_container(reply);
    const int sent = sd_bus_send(nullptr, reply, nullptr);
    sd_bus_message_unref(reply);
    return sent;
  }

  static int property(sd_bus*, const char* path, const char*, const char* name,
                      sd_bus_message* reply, void* data, sd_bus_error* error) {
    TestSystemd& self = of(data);
    const MutexLock lock(self.mutex_);
    const auto found = self.units_.find(name_of(path));
    const std::string what = name;
    const TestUnit none;
    const TestUnit& unit = found == self.units_.end() ? none : found->second;
    if (what == "LoadState")
      return sd_bus_message_append(reply, "s", found == self.units_.end() ? "not-found" : "loaded");
    if (what == "Job")
      return sd_bus_message_append(reply, "(uo)", self.said_job_ ? 1u : 0u,
                                   self.said_job_ ? "/org/freedesktop/systemd1/job/1" : "/");
    if (what == "Result") return sd_bus_message_append(reply, "s", unit.result.c_str());
    if (what == "ExecMainPID")
      return sd_bus_message_append(reply, "u", static_cast<std::uint32_t>(unit.last_pid));
    if (what == "ExecMainStartTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.began);
    if (what == "RuntimeMaxUSec") return sd_bus_message_append(reply, "t", unit.runtime_max);
    if (what == "RestartUSec") return sd_bus_message_append(reply, "t", unit.restart_delay);
    if (what == "RestartUSecNext" && !unit.next_restart_delay)
      return sd_bus_error_set(error, SD_BUS_ERROR_UNKNOWN_PROPERTY, "Unknown property");
    if (what == "RestartUSecNext")
      return sd_bus_message_append(reply, "t", *unit.next_restart_delay);
    if (what == "ConditionTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.conditions_checked);
    if (what == "InactiveEnterTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.became_inactive);
    if (what == "ActiveEnterTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.entered_active);
    if (what == "ActiveExitTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.left_active);
    if (what == "ExecMainExitTimestampMonotonic")
      return sd_bus_message_append(reply, "t", unit.ended);
    const bool lies = !self.said_active_.empty();
    if (what == "MainPID")
      return sd_bus_message_append(reply, "u",
                                   lies ? self.said_pid_ : static_cast<std::uint32_t>(unit.pid));
    return sd_bus_message_append(reply, "s",
                                 lies ? self.said_active_.c_str() : unit.active.c_str());
  }

  static int find_unit(sd_bus*, const char*, const char*, void* data, void** found, sd_bus_error*) {
    *found = data;
    return 1;
  }
};

namespace {

using Methods = TestSystemdMethods;

const sd_bus_vtable kManager[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("LoadUnit", "s", "o", Methods::load, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("StartUnit", "ss", "o", Methods::change, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("StopUnit", "ss", "o", Methods::change, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RestartUnit", "ss", "o", Methods::change, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("KillUnit", "ssi", "", Methods::change, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetUnitProperties", "sba(sv)", "", Methods::change, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetUnitByPID", "u", "o", Methods::by_pid, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ListUnitFiles", "", "a(ss)", Methods::files, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_VTABLE_END};
const sd_bus_vtable kUnit[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_PROPERTY("LoadState", "s", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ActiveState", "s", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ActiveEnterTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ActiveExitTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("InactiveEnterTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ConditionTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("Job", "(uo)", Methods::property, 0, 0),
    SD_BUS_VTABLE_END};
const sd_bus_vtable kService[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_PROPERTY("MainPID", "u", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ExecMainPID", "u", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ExecMainStartTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("ExecMainExitTimestampMonotonic", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("RuntimeMaxUSec", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("RestartUSec", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("RestartUSecNext", "t", Methods::property, 0, 0),
    SD_BUS_PROPERTY("Result", "s", Methods::property, 0, 0),
    SD_BUS_VTABLE_END};

}  // namespace

TestSystemd::TestSystemd(const TestBus& bus) {
  const auto must = [](int result) {
    if (result < 0) throw std::runtime_error("the stand-in for systemd cannot be made");
  };
  must(sd_bus_new(&bus_));
  must(sd_bus_set_address(bus_, bus.address().c_str()));
  must(sd_bus_set_bus_client(bus_, 1));
  must(sd_bus_start(bus_));
  must(sd_bus_add_object_vtable(bus_, nullptr, kPath, "org.freedesktop.systemd1.Manager", kManager,
                                this));
  must(sd_bus_add_fallback_vtable(bus_, nullptr, kUnits, "org.freedesktop.systemd1.Unit", kUnit,
                                  Methods::find_unit, this));
  must(sd_bus_add_fallback_vtable(bus_, nullptr, kUnits, "org.freedesktop.systemd1.Service",
                                  kService, Methods::find_unit, this));
  must(sd_bus_request_name(bus_, "org.freedesktop.systemd1", 0));
  thread_ = std::thread([this] { run(); });
}

TestSystemd::~TestSystemd() {
  is_ending_ = true;
  thread_.join();
  sd_bus_close_unref(bus_);
  for (auto& [name, unit] : units_) {
    if (unit.pid == 0) continue;
    kill(unit.pid, SIGKILL);
    waitpid(unit.pid, nullptr, 0);
  }
}

void TestSystemd::run() {
  while (!is_ending_) {
    {
      const MutexLock lock(mutex_);
      reap();
    }
    while (sd_bus_process(bus_, nullptr) > 0) {
    }
    constexpr std::uint64_t kMicroseconds = 5000;
    sd_bus_wait(bus_, kMicroseconds);
  }
}

void TestSystemd::reap() {
  for (auto& [name, unit] : units_) {
    int status = 0;
    if (unit.pid == 0 || waitpid(unit.pid, &status, WNOHANG) != unit.pid) continue;
    unit.pid = 0;
    const bool was_to_end = WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM;
    unit.active = was_to_end ? "inactive" : "failed";
    unit.result = was_to_end ? "success" : WIFSIGNALED(status) ? "signal" : "exit-code";
    const auto again = std::find(to_start_.begin(), to_start_.end(), name);
    if (again != to_start_.end())
      to_start_.erase(again);
    else if (!unit.restarts)
      continue;
    begin(name);
  }
}

void TestSystemd::begin(const std::string& name) {
  TestUnit& unit = units_[name];
  if (unit.pid != 0) return;
  unit.pid = unit.last_pid = program({unit.is_broken ? "false" : "sleep", "1000"}, "/dev/null");
  unit.active = "active";
}

void TestSystemd::end(TestUnit& unit, int number) {
  if (unit.pid != 0) kill(unit.pid, number);
}

void TestSystemd::add(const std::string& name, TestUnit unit) {
  const MutexLock lock(mutex_);
  units_[name] = std::move(unit);
}

int TestSystemd::start(const std::string& name) {
  const MutexLock lock(mutex_);
  begin(name);
  return units_[name].pid;
}

int TestSystemd::pid_of(const std::string& name) {
  const MutexLock lock(mutex_);
  return units_[name].pid;
}

std::vector<std::string> TestSystemd::asked() {
  const MutexLock lock(mutex_);
  return asked_;
}

void TestSystemd::refuse(const std::string& error) {
  const MutexLock lock(mutex_);
  refusal_ = error;
}

void TestSystemd::say(const std::string& active, std::uint32_t main_pid, bool has_job) {
  const MutexLock lock(mutex_);
  said_active_ = active;
  said_pid_ = main_pid;
  said_job_ = has_job;
}

// ---- systemd itself

namespace {

// It looks for a system that systemd runs, and makes control groups.
constexpr const char* kBegin = R"(
umount -R /sys/fs/cgroup || true
mount -t cgroup2 none /sys/fs/cgroup
# Not by a process number: tests that run side by side have the same ones.
group=$(mktemp -d /sys/fs/cgroup/culprit-test-XXXXXX)
mount -t tmpfs none /run
mkdir -p /run/systemd/system
end() {
  echo 1 > "$group/cgroup.kill" || true
  wait
  find "$group" -depth -type d -exec rmdir {} +
  exit
}
trap end TERM
sh -c 'echo $$ > "$0/cgroup.procs" && exec /lib/systemd/systemd --user' "$group" &
wait
)";

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

}  // namespace

std::unique_ptr<UserSystemd> UserSystemd::begin() {
  std::unique_ptr<UserSystemd> systemd(new UserSystemd);
  std::string name = (std::filesystem::temp_directory_path() / "culprit-unit-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  systemd->folder_ = name;
  const std::filesystem::path units = systemd->folder_ / "units";
  std::filesystem::create_directory(units);
  write(units / "default.target", "[Unit]\nRequires=dbus.service\n");
  for (const char* target : {"basic.target", "sockets.target", "shutdown.target"})
    write(units / target, "[Unit]\nDefaultDependencies=no\n");
  write(units / "dbus.socket", "[Socket]\nListenStream=%t/bus\n");
  write(units / "dbus.service",
        "[Unit]\nRequires=dbus.socket\n[Service]\nType=notify\nExecStart=dbus-daemon --session "
        "--address=systemd: --nofork --nopidfile --systemd-activation\n");
  setenv("XDG_RUNTIME_DIR", name.c_str(), 1);
  setenv("DBUS_SESSION_BUS_ADDRESS", ("unix:path=" + name + "/bus").c_str(), 1);
  setenv("SYSTEMD_UNIT_PATH", units.c_str(), 1);
  systemd->pid_ =
      program({"unshare", "--mount", "sh", "-euc", kBegin}, systemd->folder_ / "systemd.log");
  unsetenv("SYSTEMD_UNIT_PATH");
  for (const Time end = later(live_now(), 10s); live_now() < end;) {
    int status = 0;
    if (waitpid(systemd->pid_, &status, WNOHANG) != 0) {
      systemd->pid_ = 0;
      return nullptr;
    }
    if (std::filesystem::exists(systemd->folder_ / "bus") &&
        could_manage({"dbus.service", true}).has_value())
      return systemd;
    std::this_thread::sleep_for(20ms);
  }
  return nullptr;
}

UserSystemd::~UserSystemd() {
  unsetenv("XDG_RUNTIME_DIR");
  unsetenv("DBUS_SESSION_BUS_ADDRESS");
  if (pid_ != 0) {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  std::filesystem::remove_all(folder_);
}

void UserSystemd::start(const std::string& name, const std::string& command,
                        const std::string& settings) {
  write(folder_ / "units" / name, "[Service]\nExecStartPre=/bin/sh -c 'echo >> " +
                                      (folder_ / (name + ".starts")).string() +
                                      "'\nExecStart=" + command + "\n" + settings);
  if (const auto asked = SystemdBus(SystemdBus::Whose::kUser).start(name); !asked)
    throw std::runtime_error(asked.error());
}

int UserSystemd::starts_of(const std::string& name) const {
  std::ifstream lines(folder_ / (name + ".starts"));
  return static_cast<int>(std::count(std::istreambuf_iterator<char>(lines), {}, '\n'));
}

}  // namespace culprit::owners
